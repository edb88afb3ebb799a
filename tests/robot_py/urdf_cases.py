"""Right and wrong URDFs: what urdfdom is asked, and then ours."""

LINKS = '<link name="a"/><link name="b"/>'
PARENT_AND_CHILD = '<parent link="a"/><child link="b"/>'
LIMIT = '<limit effort="1" velocity="1"/>'
BOX = '<geometry><box size="1 1 1"/></geometry>'
MOMENTS = '<inertia ixx="1" ixy="0" ixz="0" iyy="1" iyz="0" izz="1"/>'
RED = '<color rgba="1 0 0 1"/>'


def robot(content: str) -> str:
    return f'<robot name="r">{content}</robot>'


def link(content: str) -> str:
    return robot(f'<link name="a">{content}</link>')


def visual(content: str) -> str:
    return link(f"<visual>{content}</visual>")


def shape(content: str) -> str:
    return visual(f"<geometry>{content}</geometry>")


def inertial(content: str) -> str:
    return link(f"<inertial>{content}</inertial><visual>{BOX}</visual>")


def joint(body: str, attributes: str = 'name="j" type="fixed"') -> str:
    return robot(f"{LINKS}<joint {attributes}>{body}</joint>")


def moving(more: str, kind: str = "revolute") -> str:
    return joint(PARENT_AND_CHILD + more, f'name="j" type="{kind}"')


RIGHT = link("")

DOCUMENTS = [
    *("", "   ", "\ufeff", "hello", "<robot", "<robot>", "<robot/>", "<rob/>", robot(""), RIGHT),
    f'<?xml version="1.0"?>{RIGHT}',
    f'<?xml version="1.0"?><?xacro?>{RIGHT}',
    f'<!-- x -->\n<?xml version="1.0"?>{RIGHT}',
    f"{RIGHT}<?x?>",
    '<?xml version="1.0"?>\n' + robot("<?x?><link name='a'/>"),
    f'<!DOCTYPE a [<!ENTITY x "y">]>{RIGHT}',
    f"<!DOCTYPE robot>{RIGHT}",
    *map(link, ("<!-- a -- b -->", "<!-- a", "<![CDATA[ a", "<![CDATA[ a ]]>", "<! a", "<? a")),
    link("text"),
    *(RIGHT + tail for tail in ("text", "text<x/>", "</x>junk<", "<x>", "<x", "<x a", "<x a=")),
    *(RIGHT + tail for tail in ("<x a='", "<x a=b>", "<x a='1' a='2'/>", "<x a='1'b='2'/>")),
    *(RIGHT + tail for tail in ("<x 1='1'/>", "<1/>", "< x/>", "</ x>", "<x></y>", "<x\n/ >")),
    RIGHT + "<x><y></x></y>",
    "<robot name='r'>\n<link name='a'>\n</robot>",
    "<robot name='r'>\n<link name='a'/>\n",
    "<robot name='r'>\n<link name='a'/>\n</Robot>\n",
    link("</link>"),
    '<robot name="r"/><robot/>',
    '<a/><robot name="r"><link name="x"/></robot>',
    robot('<link name="a&amp;&lt;&#65;&#x42;&foo;&#;&"/>'),
    '<robot xmlns="http://x" name="r"><link name="a"/></robot>',
    robot('<xacro:foo/><link name="a"/>'),
    *("<a>" * depth + "</a>" * depth for depth in (498, 499, 500, 502)),
    *(
        f'<robot name="q" version="{version}"><link name="a"/></robot>'
        for version in ("1.0", "1.0.", "", "x", "1", "1.", ".0", "1.0.0", "1.0a", "a.0", "-1.0")
    ),
]
LINKS_AND_MATERIALS = [
    *map(robot, ("<link/>", "<link/><link/>", '<link name="a"/><link name="a"/>', LINKS)),
    robot('<material name="m"/><link name="a"/>'),
    robot('<material/><link name="a"/>'),
    robot(f'<material name="m">{RED}</material><material name="m">{RED}</material>'),
    *(
        robot(f'<material name="m">{colour}</material><link name="a"/>')
        for colour in (
            '<color rgba="1 1 1"/>',
            '<color rgba="1 1 1 2"/>',
            '<color rgba="1 1 1 x"/><texture filename="f"/>',
            "<color/>",
        )
    ),
    robot('<material name=""><color rgba="1 0 0 1"/></material><link name="a"/>'),
    visual(f"{BOX}<material/>"),
    visual(f'{BOX}<material name="q"/>'),
    visual(f'{BOX}<material name=""/>'),
    visual(f'{BOX}<material name="q">{RED}</material>'),
    visual(f'{BOX}<material name="q"><color rgba="1 1 1 3"/></material>'),
    link(f'<visual>{BOX}<material name="q"/></visual>' * 2),
]
SHAPES = [
    visual(""),
    *map(shape, ("", "<cone/>", "<box/>", "<sphere/>", "<cylinder/>", "<mesh/>")),
    *(
        shape(f'<box size="{size}"/>')
        for size in ("1 2", "1 2 ${x}", "1,2,3", "\n1 2 3", "1 2 3 ", "1\t2 3", "1 2 &#10;3")
    ),
    *(
        shape(f'<sphere radius="{radius}"/>')
        for radius in (
            *("x", "", "1 ", " 1", "1e999", "1e-999", "inf", "nan", "0x10", "+1.", ".5", "."),
            *("1e", "1,5", "--1", "1_0", "1e+2", "٣"),
        )
    ),
    shape('<cylinder radius="1"/>'),
    shape('<cylinder radius="x" length="1"/>'),
    shape('<cylinder radius="1" length="y"/>'),
    shape('<cylinder radius="x" length="y"/>'),
    shape('<mesh filename="a"/>'),
    shape('<mesh filename="a" scale="1 1"/>'),
    shape('<mesh filename="a" scale=""/>'),
    shape('<mesh filename=""/>'),
    visual(f'<origin xyz="1 2"/>{BOX}'),
    visual(f'<origin rpy="pi 0 0"/>{BOX}'),
    visual(f"<origin/>{BOX}"),
    link(f"<collision/><visual>{BOX}</visual>"),
    link("<collision><geometry><box/></geometry></collision>"),
    *(
        inertial(content)
        for content in (
            "",
            MOMENTS,
            '<mass value="1"/>',
            f"<mass/>{MOMENTS}",
            f'<mass value="x"/>{MOMENTS}',
            '<mass value="1"/><inertia/>',
            f'<mass value="1"/>{MOMENTS}',
            '<mass value="1"/><inertia ixx="1" ixy="0" ixz="0" iyy="1" izz="1"/>',
            '<mass value="1"/><inertia ixx="1" ixy="q" ixz="0" iyy="1" iyz="p" izz="1"/>',
            f'<origin xyz="1"/><mass value="1"/>{MOMENTS}',
        )
    ),
]
JOINTS = [
    *(
        joint(PARENT_AND_CHILD, attributes)
        for attributes in (
            'name="j" type="fixed"',
            'name="j"',
            'type="fixed"',
            'name="j" type="Fixed"',
        )
    ),
    *(
        joint(body)
        for body in (
            "",
            '<parent link="a"/>',
            "<parent/><child/>",
            '<parent link="x"/><child link="b"/>',
            '<parent link="a"/><child link="x"/>',
            '<parent link="x"/><child link="y"/>',
            f'<origin xyz="a b c"/>{PARENT_AND_CHILD}',
            f'<origin rpy="1 2 3 4"/>{PARENT_AND_CHILD}',
        )
    ),
    *(moving("", kind) for kind in ("revolute", "prismatic", "continuous", "planar", "floating")),
    *(moving("<limit/>", kind) for kind in ("revolute", "continuous", "fixed")),
    moving('<limit effort="1"/>'),
    moving('<limit velocity="1"/>'),
    moving('<limit effort="x" velocity="1"/>'),
    moving('<limit effort="1" velocity="y"/>'),
    moving('<limit lower="x" effort="1" velocity="1"/>'),
    moving('<limit upper="" effort="1" velocity="1"/>'),
    *(
        moving(LIMIT + more)
        for more in (
            *("", "<axis/>", '<axis xyz="0 0"/>', '<axis xyz="0 0 0"/>', "<mimic/>", "<dynamics/>"),
            *('<mimic joint="k"/>', '<mimic joint="k" multiplier="x"/>'),
            *('<mimic joint="k" offset="x"/>', '<dynamics damping="x"/>'),
            *('<dynamics friction="x"/>', '<dynamics damping="1"/>', "<safety_controller/>"),
            '<safety_controller k_velocity="1"/>',
            '<safety_controller soft_lower_limit="x" k_velocity="1"/>',
            '<safety_controller k_velocity="x"/>',
            '<safety_controller k_position="x" k_velocity="1"/>',
            *('<calibration rising="x"/>', '<calibration falling="x"/>', "<calibration/>"),
        )
    ),
    *(moving(f'{LIMIT}<axis xyz="q"/>', kind) for kind in ("fixed", "floating", "planar")),
    robot(LINKS + f'<joint name="j" type="fixed">{PARENT_AND_CHILD}</joint>' * 2),
    robot(
        f'{LINKS}<joint name="j" type="fixed">{PARENT_AND_CHILD}</joint>'
        '<joint name="k" type="fixed"><parent link="b"/><child link="a"/></joint>'
    ),
    joint('<parent link="a"/><child link="a"/>'),
    robot(f'<link name="c"/>{LINKS}<joint name="j" type="fixed">{PARENT_AND_CHILD}</joint>'),
]
CASES = [*DOCUMENTS, *LINKS_AND_MATERIALS, *SHAPES, *JOINTS]
