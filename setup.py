from glob import glob

from setuptools import setup

PACKAGE = 'omega_turn_ros'

setup(
    name=PACKAGE,
    version='0.1.0',
    packages=[
        'omega_turn_ros',
        'omega_turn_ros.compliance',
        'omega_turn_ros.config',
        'omega_turn_ros.config.gaits',
        'omega_turn_ros.config.robots',
        'omega_turn_ros.design',
        'omega_turn_ros.gaits',
        'omega_turn_ros.mechanics',
        'omega_turn_ros.nodes',
        'omega_turn_sim_bridge',
        'omega_turn_lab',
        'omega_turn_lab.studies',
    ],
    package_dir={
        'omega_turn_ros.config': 'config',
        'omega_turn_ros.config.gaits': 'config/gaits',
        'omega_turn_ros.config.robots': 'config/robots',
    },
    package_data={
        'omega_turn_ros': ['py.typed'],
        'omega_turn_sim_bridge': ['py.typed'],
        'omega_turn_lab': ['py.typed'],
        'omega_turn_lab.studies': ['*.yaml'],
        'omega_turn_ros.config': ['*.yaml'],
        'omega_turn_ros.config.gaits': ['*.yaml'],
        'omega_turn_ros.config.robots': ['*.yaml'],
    },
    data_files=[
        ('share/ament_index/resource_index/packages', ['resource/' + PACKAGE]),
        ('share/' + PACKAGE, ['package.xml']),
        ('share/' + PACKAGE + '/launch', glob('launch/*.launch.py')),
        ('share/' + PACKAGE + '/config', glob('config/*.yaml')),
        ('share/' + PACKAGE + '/config/gaits', glob('config/gaits/*.yaml')),
        ('share/' + PACKAGE + '/config/robots', glob('config/robots/*.yaml')),
    ],
    python_requires='>=3.10',
    install_requires=[
        'setuptools',
        'numpy>=1.26',
        'PyYAML>=6',
        'scipy>=1.10',
        'numba>=0.59',
        'cma>=3.3',
    ],
    extras_require={
        'ros': ['ros-jazzy-rclpy[fastrtps]', 'ros-jazzy-common-interfaces'],
        'sim': ['pybullet>=3.2.5'],
        'lab': [
            'matplotlib>=3.7',
            'pillow>=9',
            'tqdm>=4.60',
            'joblib>=1.4',
            'rich>=13',
            'shapely>=2',
            'mcap>=1.0',
            'mcap-ros2-support>=0.5',
        ],
        'cluster': ['dask[distributed]>=2023.1'],
        'test': [
            'hypothesis>=6',
            'mypy>=1.8',
            'psutil>=5',
            'pytest>=7',
            'pytest-timeout>=2',
            'ruff>=0.6',
            'types-PyYAML',
        ],
    },
    zip_safe=False,
    maintainer='omega_turn_ros maintainers',
    maintainer_email='maintainers@example.org',
    description='Omega turns for limbless and many-legged robots: gaits, mechanics, compliance',
    license='Apache-2.0',
    tests_require=['pytest'],
    entry_points={
        'console_scripts': [
            'gait_node = omega_turn_ros.nodes.gait_node:main',
            'admittance_node = omega_turn_ros.nodes.admittance_node:main',
            'pybullet_bridge = omega_turn_sim_bridge.bridge_node:main',
            'omega_turn = omega_turn_lab.cli:main',
        ],
    },
)
