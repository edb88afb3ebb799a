"""Draws definitions at random, with all that the language has."""

from functools import partial

WHOLE = {
    f"{sign}int{bits}": ((0, 2**bits - 1) if sign else (-(2 ** (bits - 1)), 2 ** (bits - 1) - 1))
    for bits in (8, 16, 32, 64)
    for sign in ("", "u")
}
WHOLE |= {"byte": (0, 255), "char": (0, 255)}
BASIC = [*WHOLE, "bool", "float32", "float64"]
STRINGS = ["string", "wstring", "string<=7", "wstring<=4"]
OTHERS = ["geometry_msgs/Point", "builtin_interfaces/Time", "std_msgs/Header", "std_msgs/Empty"]
TEXTS = ["", "a", " b ", "it's", "c d", "\\t", "x, y", "é雪"]


def value(rng, kind):
    if kind in WHOLE:
        low, high = WHOLE[kind]
        whole = rng.choice([low, high, rng.randint(low, high), min(high, 7)])
        return rng.choice([str(whole), hex(whole)])
    if kind == "bool":
        return rng.choice(["true", "false", "True", "0", "1"])
    if kind.startswith("float"):
        return rng.choice(["0", "-1.5", "1e-3", "+2.", "1e20", "3.25", f"{rng.uniform(-9, 9)}"])
    text = rng.choice([each for each in TEXTS if len(each) < 4 or "<=" not in kind])
    return f'"{text}"' if "'" in text or rng.random() < 0.5 else f"'{text}'"


def field(rng, name, own):
    kind = rng.choice([*BASIC, *BASIC, *STRINGS, *OTHERS, *own])
    one = partial(value, rng, kind)
    size = rng.choice([0, 0, 0, 1, 2, 3])
    form = rng.choice(["", "", "[]", "[{n}]", "[<={n}]"]) if size else ""
    has_default = kind in BASIC + STRINGS and rng.random() < 0.4
    default = ""
    if has_default and form:
        values = [ascii_only(one) if kind in STRINGS else one() for _ in range(size)]
        default = f" [{', '.join(values)}]"
    elif has_default:
        default = f" {one()}"
    comment = rng.choice(["", "", "", "  # what it is [m]"])
    return f"{kind}{form.format(n=size)}{rng.choice([' ', '  '])}{name}{default}{comment}"


def ascii_only(draw):
    """A text that the generators take in an array."""
    while not (text := draw()).isascii() or "\\" in text:
        pass
    return text


def part(rng, own, which):
    lines = [f"# {rng.random()}"] * rng.randint(0, 2)
    for number in range(rng.choice([0, 1, 2, 3, 5, 8])):
        if rng.random() < 0.2:
            kind = rng.choice([*BASIC, "string", "wstring"])
            # rosidl_parser 4.6 forgets the second of two constants that are the same in a file
            name = f"C_{which}_{number}"
            lines.append(f"{kind} {name}{rng.choice(['=', ' = '])}{value(rng, kind)}")
        else:
            lines.append(field(rng, rng.choice(["f{n}", "a_{n}", "of_{n}x"]).format(n=number), own))
        lines += [""] * rng.randint(0, 1)
    return "\n".join(lines)


def package(rng, name, count):
    """Draw so many definitions, of which later ones have earlier ones as fields."""
    own = []
    texts = {}
    for number in range(count):
        kind = rng.choice(["msg", "msg", "msg", "srv", "action"])
        short = rng.choice(["M{n}", "ABCd{n}", "OneTwo{n}", "T{n}X"]).format(n=number)
        known = [*own[-8:], *(f"{name}/{each}" for each in own[-2:])]
        count_of_parts = {"msg": 1, "srv": 2, "action": 3}[kind]
        parts = [part(rng, known, which) for which in range(count_of_parts)]
        texts[f"{name}/{kind}/{short}"] = "\n---\n".join(parts) + "\n"
        if kind == "msg":
            own.append(short)
    return texts
