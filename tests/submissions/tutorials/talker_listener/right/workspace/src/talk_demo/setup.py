from glob import glob

from setuptools import find_packages, setup

package_name = 'talk_demo'

setup(
    name=package_name,
    version='0.0.0',
    packages=find_packages(exclude=['test']),
    data_files=[
        ('share/ament_index/resource_index/packages',
            ['resource/' + package_name]),
        ('share/' + package_name, ['package.xml']),
        ('share/' + package_name + '/launch', glob('launch/*')),
    ],
    install_requires=['setuptools'],
    zip_safe=True,
    maintainer='student',
    maintainer_email='student@example.org',
    description='Two nodes and a launch file',
    license='Apache-2.0',
    entry_points={
        'console_scripts': [
            'publisher_node = talk_demo.publisher_node:main',
            'subscriber_node = talk_demo.subscriber_node:main',
        ],
    },
)
