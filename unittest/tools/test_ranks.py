"""As a scene grows with the ranks, what a rank has and sends stays, and the scene is that of one
rank (tools/cost ranks)."""

import sys

import pytest

from fsi import paths

sys.path.insert(0, str(paths.ROOT / "bench"))
import measure  # noqa: E402
import ranks  # noqa: E402

# 24 steps of round-off, 1e-16 of a sum, grown by sound and, in the plate, by a stiffness of 1e4
# weights; a missing ghost shows at 1e-4
ROUND = 1e-9
PART = 0.05  # levels make particles in some cells earlier than in others
# what does grow: each floating block adds force and torque of a step, twice; on 9 x 3 ranks an end
# meets eight others, on 4 x 2 five
MPI = 2**18  # bytes that Open MPI keeps for another rank
GROWS = {("floating blocks", "reduced"): (27 - 8) * 2 * 6 * 8, ("open ends", "messages"): 2
         * (8 - 5)}


@pytest.mark.parametrize("kind", ranks.KINDS)
def test_scene_is_that_of_one_rank(kind):
    assert ranks.difference(kind, 27) < ROUND


@pytest.mark.parametrize("kind", ranks.KINDS)
def test_a_rank_of_27_sends_what_one_of_8_does(kind):
    few, many = (measure.messages([ranks.deck(kind, n)], n, max)[0] for n in (8, 27))
    for name in ("ghosts", "messages", "bytes", "collectives", "reduced", "memory"):
        assert many[name] <= (1 + PART) * few[name] + GROWS.get((kind, name), MPI * (27 - 8)
                                                                * (name == "memory")), name
    assert few["messages"] > 4 and few["bytes"] > 1e4


def test_cells_move():
    """Or agreement would mean nothing: the water's velocity is 0.2 m/s, a twentieth of a
    spacing."""
    before = ranks.state("water", 8, 1)
    assert abs(before[:, 3:6]).max() > 0.1 and abs(before[:, 6] - 1000).max() > 0.1
