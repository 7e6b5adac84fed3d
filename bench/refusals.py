"""The manual's table of what does not go together, from that in the sources
(src/FSI/fsi_refusals.h)."""

import re

from tool import as_csv

from fsi import paths

TABLE = paths.ROOT / "src/FSI/fsi_refusals.h"
TEXT = r'"(?:[^"\\]|\\.)*"|\w+'
ENDS = "Fix fsi/inlet, fix fsi/outlet"    # what {} alone stands for
def table():
    """[(group, name, rule, what, with, why)]"""
    text = TABLE.read_text()
    words = {name: value for name, value in re.findall(r'constexpr char (\w+)\[\] = "([^"]*)"',
                                                       text)}

    def said(part):
        return words[part] if part in words else "".join(re.findall(r'"((?:[^"\\]|\\.)*)"', part))

    found, group = [], ""
    row = re.compile(
        rf"// (?P<group>[\w ,]+)\n|(?P<name>[A-Z_0-9]+)\s*=\s*\{{(?P<rule>REQUIRES|NOT_WITH),"
        rf"\s*(?P<what>(?:{TEXT}|\s)+),\s*(?P<with>(?:{TEXT}|\s)+),\s*(?P<why>(?:{TEXT}|\s)+)\}}")
    for m in row.finditer(text[text.index("// fix fsi\n"):]):
        if m["group"]:
            group = m["group"]
        else:
            found.append((group, m["name"], m["rule"],
                          *(said(m[part].strip()) for part in ("what", "with", "why"))))
    return found


def shown(text):
    """Placeholders as a reader takes them."""
    if text == "{}":
        return ENDS
    return re.sub(r"\{[^}]*\}", "*N*", text)


def page():
    """The rows of the table as CSV."""
    verbs = {"REQUIRES": "requires", "NOT_WITH": "does not go with"}
    rows = [[shown(what), f"{verbs[rule]} {shown(other)}", shown(why)]
            for _, _, rule, what, other, why in table()]
    return as_csv([["what", "", "because"], *rows])
