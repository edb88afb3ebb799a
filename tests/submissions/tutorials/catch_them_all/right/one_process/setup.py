from glob import glob

from setuptools import find_packages, setup

package_name = 'catch_all'

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
    description='Catch them all',
    license='Apache-2.0',
    entry_points={
        'console_scripts': [
            'catch_all = catch_all.main:main',
        ],
    },
)
