"""tools/proof: hashes of what scenes leave are the same for the same sources, and others for
another scene."""

import json

from fsi import paths, proof


def test_same_and_other(tmp_path, capsys):
    file = tmp_path / "hashes.json"
    assert proof.main([str(file), "--only", "^droplet/in"]) == 0
    found = json.loads(file.read_text())
    assert len(found) == len(proof.FORMS) and all(len(value) == 64 for value in found.values())
    assert len(set(found.values())) == len(found)
    file.write_text(json.dumps({**found, "droplet/in.droplet, 2 ranks": "0" * 64}))
    capsys.readouterr()
    assert proof.main([str(file), "--only", "^droplet/in"]) == 1
    assert capsys.readouterr().out.splitlines()[-1] == f"{len(found) - 1} of {len(found)} as before"


def test_every_scene_has_a_deck():
    assert {name.split("/")[0] for name in proof.decks()} >= set(paths.examples())
    text = proof.begun("fix 1\nrun 0\nvariable n equal 2\nrun 500 upto\nrun 7\n", 3, "newton off\n")
    assert (text == "newton off\nfix 1\nrun 0\nvariable n equal 2\n\nrun 3\n"
            "write_restart left.restart\n")
