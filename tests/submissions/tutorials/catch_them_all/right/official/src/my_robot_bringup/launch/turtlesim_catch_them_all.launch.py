from launch import LaunchDescription
from launch_ros.actions import Node


def generate_launch_description():
    ld = LaunchDescription()

    turtle_spawner_node = Node(
        package='turtlesim_catch_them_all',
        executable='turtle_spawner',
        parameters=[
            {'spawn_period': 1.5},
            {'turtle_name_prefix': 'my_turtle'},
        ],
    )

    turtle_controller_node = Node(
        package='turtlesim_catch_them_all',
        executable='turtle_controller',
        parameters=[
            {'catch_closest_turtle_first': True},
        ],
    )

    ld.add_action(turtle_spawner_node)
    ld.add_action(turtle_controller_node)
    return ld
