"""Parts of right and wrong URDFs."""

LINKS = '<link name="a"/><link name="b"/>'
PARENT_AND_CHILD = '<parent link="a"/><child link="b"/>'
LIMIT = '<limit effort="1" velocity="1"/>'
BOX = '<geometry><box size="1 1 1"/></geometry>'
RED = '<color rgba="1 0 0 1"/>'


def robot(content: str) -> str:
    return f'<robot name="r">{content}</robot>'


def link(content: str) -> str:
    return robot(f'<link name="a">{content}</link>')


def visual(content: str) -> str:
    return link(f"<visual>{content}</visual>")


def shape(content: str) -> str:
    return visual(f"<geometry>{content}</geometry>")


def joint(body: str, attributes: str = 'name="j" type="fixed"') -> str:
    return robot(f"{LINKS}<joint {attributes}>{body}</joint>")


def moving(more: str, kind: str = "revolute") -> str:
    return joint(PARENT_AND_CHILD + more, f'name="j" type="{kind}"')


RIGHT = link("")
