"""What a launch file would start stands in a table, with the line that says so."""

from grader.submission.launched import HEADINGS, tables
from tests.grader_robots.inspection.test_launches import FILE, traced


def rows(folder, body: str):
    """Of the first launch file: its cells as texts, and which are marked."""
    (table,) = tables(traced(folder, {FILE: body}))
    assert table.headings == HEADINGS
    assert all(len(row) == len(HEADINGS) for row in table.rows)
    texts = [tuple(" | ".join(map(str, cell.lines)) for cell in row) for row in table.rows]
    marked = [
        [cell.is_wrong for cell in row].index(True)
        for row in table.rows
        if any(c.is_wrong for c in row)
    ]
    return table, texts, marked


def test_a_node_says_what_it_gets_and_where_that_is_written(tmp_path):
    _, texts, marked = rows(
        tmp_path,
        """
        return LaunchDescription([
            Node(package='rviz2', executable='rviz2', name='eye', namespace='left',
                 arguments=['--help'], parameters=[{'use_sim_time': True}],
                 remappings=[('tf', '/tf')]),
        ])
        """,
    )
    told = "use_sim_time = true | --help | remaps tf:=/tf"
    assert texts == [("rviz2", "rviz2", "left/eye", told, "launch/display.launch.py, line 11")]
    assert marked == []


def test_a_node_whose_condition_is_not_met_is_told(tmp_path):
    _, texts, _ = rows(
        tmp_path,
        """
        gui = LaunchConfiguration('gui')
        return LaunchDescription([
            DeclareLaunchArgument('gui', default_value='true'),
            Node(package='rviz2', executable='rviz2', condition=IfCondition(gui)),
            Node(package='rviz2', executable='rviz2', condition=UnlessCondition(gui)),
        ])
        """,
    )
    assert [text[3] for text in texts] == [
        "if $(var gui): it is so by default",
        "not started: unless $(var gui) is not so by default",
    ]


def test_what_is_missing_is_marked_where_it_is_named(tmp_path):
    _, texts, marked = rows(
        tmp_path,
        """
        return LaunchDescription([
            Node(package='walker_descripton', executable='a'),
            Node(package='rviz2', executable='rviz3'),
            Node(package='rviz2', executable='rviz2', arguments=['-d', '/home/me/a.rviz']),
        ])
        """,
    )
    assert [text[0] for text in texts] == ["walker_descripton", "rviz2", "rviz2"]
    assert marked == [0, 1, 3]


def test_a_launch_file_that_ends_with_an_error_says_which(tmp_path):
    table, texts, _ = rows(tmp_path, "raise ValueError('<b>')")
    assert texts == []
    assert str(table.note) == "It ends with ValueError: <b> (launch/display.launch.py, line 10)."


def test_a_launch_file_in_xml_has_its_file_without_a_line(tmp_path):
    xml = '<launch><node pkg="rviz2" exec="rviz2"/></launch>'
    (table,) = tables(traced(tmp_path, {"launch/a.launch.xml": xml}))
    assert table.rows[0][-1].lines == ("launch/a.launch.xml",)
