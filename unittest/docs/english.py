"""What is wrong with the English of a user page. `faults` is a function of the page's text
alone."""

import re

LINE = 160      # characters of a line outside of tables
MEAN = 22       # words of a mean sentence: a page must be below
LONGEST = 45    # words of any sentence

_NUMBER = (
    r"(?:\d+|n|one|two|three|four|five|six|seven|eight|nine|ten|eleven|twelve|fourteen|fifteen|"
    r"sixteen|twenty|thirty|forty|fifty|"
    r"particles?|rows?|spacings?)")
_BODY = r"(?:flag|plates?|gate|cylinder|baffle|beam|rubber|body|thickness|column|solid)"
# Words of this house and what a reader of the field expects instead; history of the work, which is
# for doc/notes
HOUSE = (
    (rf"\b{_NUMBER} across\b|\bacross (?:the|a) {_BODY}\b",
     "particles through the thickness, or per diameter"),
    (r"\b(?:bears?|bore|borne)\b", "remains stable up to"),
    (r"\bbeside\b", "next to, compared with"),
    (r"\bbut for\b", "except"),
    (r"\bledgers?\b", "energy balance"),
    (r"(?<!fsi/)\bwatch(?:es)?\b", "monitor; the style is fix fsi/watch"),
    (r"\bthe (?:source )?paper\b", "its name"),
    (r"\bone run each\b|\bother work\b|\buntil today\b|\b(?:older|earlier) commits?\b",
     "nothing: a user page has no history"),
)
# Words that save the writer a noun, a verb or a reason, and cost the reader a second look
COMPRESSED = (
    (r"\b(?:that|those) of\b", "name the thing again, or a genitive"),
    (r", too\b(?! "
     r"(?:high|low|few|many|much|far|fast|slow|large|small|soft|stiff|thin|thick|short|long|late|"
     r"early)\b)", "also"),
    (r"\banew\b", "again"),
    (r"\bgo(?:es)? with(?:out)?\b(?! fix F)", "can, cannot be combined with"),
    (r"\bcomes? around\b", "re-enters"),
    (r"\bof (?:its|their) own\b(?! body)", "separate, or nothing"),
    (r"\bsome \d", "about"),
    (r"%\)? off\b", "an error of ... %"),
    (r"\bstruck\b|\bstrikes?\b", "hit"),
    (r"\b(?:merging|splitting|shifting|damping|spacing|tool|scene|script) takes\b",
     "a verb of what happens"),
    (r"(?<!\.\.[ ])\bdecks?\b", "input script"),
    (r"\bthe article's scheme\b", "the original scheme"),
    (r"\bWhat (?:naming|is not named|goes)\b", "each optional effect; cannot be combined"),
)
_ISE = ("organ real recogn normal initial minim maxim optim summar vector digit stabil discret "
        "parametr visual parallel linear standard penal symmetr "
        "general special emphas util categor synchron local central neutral equal polar crystal "
        "fluid character").split()
_BRITISH = (
    r"neighbour\w*|colour\w*|behaviour\w*|favour\w*|honour\w*|labour\w*|vapour\w*|rigour|"
    r"endeavour\w*|armour|harbour\w*|"
    r"cent(?:re|res|red|ring)|(?:kilo|centi|milli|micro|nano)?met(?:re|res)|lit(?:re|res)|"
    r"fib(?:re|res)|theatres?|sabre|calibre|"
    r"modell(?:ed|ing|er)|travell(?:ed|ing|er)|cancell(?:ed|ing)|labell(?:ed|ing)|channell(?:ed|"
    r"ing)|signall(?:ed|ing)|levell(?:ed|ing)|"
    r"grey\w*|analys(?:e|ed|er|ing)|paralys(?:e|es|ed)|catalys(?:e|es|ed)|fulfils?|licence\w*|"
    r"defence\w*|offence\w*|artefacts?|whilst|amongst|"
    r"programmes?|judgement\w*|ageing|ploughs?|plough\w*|sceptic\w*|aluminium|moulds?|mouldings?|"
    r"manoeuv\w+|tyres?|storeys?|"
    rf"(?:{'|'.join(_ISE)})is(?:e|es|ed|ing|ation|ations)")
HASH = r"\b(?=[0-9a-f]*[0-9])(?=[0-9a-f]*[a-f])[0-9a-f]{7,40}\b"
_SHORT = r"\b(?:e\.g|i\.e|et al|vs|cf|approx|resp|Fig|Figs|Eq|Eqs|No|Sec|Mr|Dr|art|vol|pp|[A-Z])\."
_SILENT = (
    "code-block|math|parsed-literal|index|list-table|table|csv-table|image|figure|toctree|raw|"
    "literalinclude|include|role|meta|only")


def faults(text, markup="md", house=HOUSE + COMPRESSED):
    """[what is wrong]: markup is md or rst."""
    found = []
    plain = _plain(text, markup)
    for number, line in enumerate(text.splitlines(), 1):
        if len(line) > LINE and not _in_table(text, number, markup):
            found.append(f"line {number} has {len(line)} characters")
    found += [f"a commit's hash: {word}" for word in re.findall(HASH, text)]
    found += [f"the mark {mark}" for mark in re.findall(r"\(\\?\*\)", text)]
    for pattern, instead in house:
        found += [f"'{_space(match[0])}': {instead}"
                  for match in re.finditer(pattern.replace(" ", r"\s+"), plain, re.I)]
    found += [f"'{match[0]}': American spelling"
              for match in re.finditer(rf"\b(?:{_BRITISH})\b", plain, re.I)]
    lengths = [(len(words(s)), s) for s in sentences(text, markup)]
    found += [f"a sentence of {length} words: {s[:60]}..." for length, s in lengths if length
              > LONGEST]
    counted = [length for length, _ in lengths if length > 3]
    if counted and sum(counted) / len(counted) >= MEAN:
        found.append(f"a mean sentence of {sum(counted) / len(counted):.1f} words")
    return found


def length(text, markup="md"):
    """Words and numbers of a page, those in tables, too; code in the text counts as one, blocks of
    code and formulas do not."""
    return len(words(_plain(text, markup)))


def words(sentence):
    return [word for word in sentence.split() if re.search(r"\w", word)]


def sentences(text, markup="md"):
    """Sentences of the running text: no headings, tables, code, formulas, pictures, and no list of
    references."""
    found = []
    for block in _blocks(text, markup):
        block = re.sub(_SHORT, lambda m: m[0].replace(".", "\0"), _space(_plain(block, markup)))
        found += [s.replace("\0", ".")
                  for s in re.split(r"(?<=[.!?])[\"')\]*]*\s+(?=[\"'(\[*]*[A-Z0-9])", block)
                  if words(s)]
    return found


def _space(text):
    return " ".join(text.split())


def _plain(text, markup):
    """Without code, formulas and targets of links, which are no English; code in the text counts as
    one word."""
    if markup == "md":
        text = re.sub(r"^```.*?^```[ \t]*$", "", text, flags=re.M | re.S)
        text = re.sub(r"<!--.*?-->|<[^>\n]+>", " ", text, flags=re.S)
        text = re.sub(r"`[^`]+`", "X", text)
        return re.sub(r"!?\[([^\]]*)\]\([^)]*\)", r"\1", text)
    text = re.sub(
        r"^( *)\.\. "
        r"(?:code-block|math|parsed-literal|raw|index|image|toctree|csv-table)::.*\n(?:\1 .*\n|[ "
        r"\t]*\n)*", "", text, flags=re.M)
    text = re.sub(r"``[^`]+``|:math:`[^`]+`", "X", text)
    text = re.sub(r":[\w-]+:`(?:([^`<]*?)\s*<[^`]*>|([^`]*))`", lambda m: m[1] or "X", text)
    return re.sub(r"`([^`<]+)(?:\s*<[^`]*>)?`_+", r"\1", text).replace("\\ ", "").replace("\\", "")


def _in_table(text, number, markup):
    lines = text.splitlines()
    line = lines[number - 1]
    if markup == "md":
        return line.lstrip().startswith("|")
    for k in range(number - 2, -1, -1):  # the directive that the line is indented below
        if lines[k].strip() and _indent(lines[k]) < _indent(line):
            if re.match(r"\s*\.\. (?:list-|csv-)?table::", lines[k]):
                return True
            line = lines[k]
    return _within_rules(lines, number - 1)


def _within_rules(lines, at):
    """A simple table of reStructuredText: between rows of several ==== side by side."""
    rules = [k for k, line in enumerate(lines) if re.match(r"\s*=+(?: +=+)+\s*$", line)]
    return bool(rules) and rules[0] <= at <= rules[-1] and not any(
        not line.strip() for line in lines[max(k for k in rules if k <= at):at])


def _indent(line):
    return len(line) - len(line.lstrip())


def _blocks(text, markup):
    """Paragraphs and items of lists."""
    return _markdown(text) if markup == "md" else _restructured(text)


def _markdown(text):
    text = re.sub(r"^```.*?^```[ \t]*$", "\n", text, flags=re.M | re.S)
    text = re.sub(r"^#+ (?:References|Literature)[ \t]*\n.*?(?=^#|\Z)", "", text, flags=re.M | re.S)
    text = re.sub(r"<!--.*?-->", "\n", text, flags=re.S)
    block, found = [], []
    for line in [*text.splitlines(), ""]:
        bare = line.strip()
        ends = not bare or bare.startswith(("#", "|", "![", "<", "---"))
        if ends or re.match(r"(?:[-*+]|\d+\.) ", bare):
            found.append(" ".join(block))
            block = []
        if not ends:
            block.append(re.sub(r"^(?:[-*+]|\d+\.) |^> ", "", bare))
    return [b for b in found if b]


def _restructured(text):
    lines, found, block, skip = text.splitlines(), [], [], None
    for k, line in enumerate([*lines, ""]):
        if skip is not None and line.strip() and _indent(line) <= skip:
            skip = None
        if skip is not None:
            continue
        following = lines[k + 1] if k + 1 < len(lines) else ""
        bare = line.strip()
        heading = (bool(bare) and bool(re.match(r"([=\-~^\"'*+#])\1{2,}\s*$", following))
                   and not re.match(r"[=\-]+ +[=\-]", following))
        rule = bool(re.match(r"([=\-~^\"'*+#.])\1{2,}\s*$", bare)) or _within_rules(lines, k)
        directive = re.match(r"\.\. (?:([\w-]+)::)?", bare)
        if not bare or heading or rule or directive or re.match(r"(?:[-*+]|\d+\.|#\.|:\w+:) ",
                                                                bare):
            found.append(" ".join(block))
            block = []
        if directive:
            if directive[1] is None or re.fullmatch(_SILENT, directive[1]):
                skip = _indent(line)
            continue
        if bare and not (heading or rule or re.match(r":[\w-]+:", bare)
                         and not bare.startswith((":doc:", ":math:", ":ref:", ":lammps:"))):
            block.append(re.sub(r"^(?:[-*+]|\d+\.|#\.) ", "", bare))
    return [b for b in found if b]
