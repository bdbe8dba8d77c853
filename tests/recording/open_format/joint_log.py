# Two joints at 50 Hz, their commands at 20 Hz of the recorder's clock, which is 3 s behind, an inertial sensor at 80 Hz, and the same
# table as CSV.
import math
from pathlib import Path
import numpy as np
from rosbags.rosbag2 import StoragePlugin, Writer
from rosbags.typesys import Stores, get_typestore
store = get_typestore(Stores.ROS2_HUMBLE)
cls = lambda name: store.types[name]
ORIGIN, LATE = 1700000000_000000000, -3_000000000
def header(ns, frame=''):
    time = cls('builtin_interfaces/msg/Time')(sec=ns // 10**9, nanosec=ns % 10**9)
    return cls('std_msgs/msg/Header')(stamp=time, frame_id=frame)
def angles(t): return [math.sin(3 * t), 0.5 * math.cos(2 * t)]
def speeds(t): return [3 * math.cos(3 * t), -math.sin(2 * t)]
def commands(t): return [math.sin(3.1 * t), 0.5 * math.cos(2.1 * t)]
V = cls('geometry_msgs/msg/Vector3')
def joint_state(ns, t, names=('pan', 'arm/lift')):
    order = [('pan', 'arm/lift').index(name) for name in names]
    return cls('sensor_msgs/msg/JointState')(header=header(ns), name=list(names),
        position=np.array([angles(t)[k] for k in order]), velocity=np.array([speeds(t)[k] for k in order]), effort=np.array([]))
def numbers(ns, t):
    layout = cls('std_msgs/msg/MultiArrayLayout')(dim=[], data_offset=0)
    return cls('std_msgs/msg/Float64MultiArray')(layout=layout, data=np.array(commands(t)))
def point(t, position, after):
    time = cls('builtin_interfaces/msg/Duration')(sec=0, nanosec=after)
    none = np.array([])
    return cls('trajectory_msgs/msg/JointTrajectoryPoint')(positions=np.array(position), velocities=none,
        accelerations=none, effort=none, time_from_start=time)
def plan(ns, t):
    return cls('trajectory_msgs/msg/JointTrajectory')(header=header(0), joint_names=['arm/lift', 'pan'],
        points=[point(t, commands(t)[::-1], 0)])
def imu(ns, t):
    Q = cls('geometry_msgs/msg/Quaternion')
    return cls('sensor_msgs/msg/Imu')(header=header(ns, 'hand'), orientation=Q(0.0, 0.0, 0.0, 1.0),
        orientation_covariance=np.zeros(9), angular_velocity=V(2 * t, 0.0, 1.0), angular_velocity_covariance=np.zeros(9),
        linear_acceleration=V(0.0, 0.0, 9.81), linear_acceleration_covariance=np.zeros(9))
STATE = ('/joint_states', 'sensor_msgs/msg/JointState', 20, joint_state)
NUMBERS = ('/forward/commands', 'std_msgs/msg/Float64MultiArray', 50, numbers)
PLAN = ('/arm/joint_trajectory', 'trajectory_msgs/msg/JointTrajectory', 50, plan)
IMU = ('/imu', 'sensor_msgs/msg/Imu', 12, imu)
TWISTED = ('/joint_states', 'sensor_msgs/msg/JointState', 20,
    lambda ns, t: joint_state(ns, t, ('pan', 'arm/lift') if round(50 * t) % 2 else ('arm/lift', 'pan')))
def write(name, plugin, topics):
    with Writer(Path(name), version=9, storage_plugin=plugin) as writer:
        where = {}
        for topic, kind, every_ms, make in topics:
            where[topic] = writer.add_connection(topic, kind, typestore=store)
        rows = [(ns, topic, kind, make) for topic, kind, every_ms, make in topics for ns in range(0, 2_000_000_001, every_ms * 10**6)]
        for ns, topic, kind, make in sorted(rows, key=lambda row: row[0]):
            data = store.serialize_cdr(make(ORIGIN + ns, ns * 1e-9), kind)
            writer.write(where[topic], ORIGIN + LATE + ns, data)
for plugin, ending in ((StoragePlugin.SQLITE3, 'db3'), (StoragePlugin.MCAP, 'mcap')):
    write(f'numbers_{ending}', plugin, [STATE, NUMBERS])
    write(f'plan_{ending}', plugin, [STATE, PLAN, IMU])
    write(f'order_{ending}', plugin, [TWISTED])
    write(f'two_{ending}', plugin, [STATE, ('/joint_commands',) + STATE[1:]])
    write(f'both_{ending}', plugin, [STATE, PLAN, ('/leg/joint_trajectory',) + PLAN[1:]])
with open('own.csv', 'w') as file:
    file.write('t_s,pan_rad,arm_lift_rad,pan_rad_s,arm_lift_rad_s,pan_command_rad,arm_lift_command_rad\n')
    for k in range(101):
        ns = k * 20_000_000
        t, held = ns * 1e-9, (ns // 50_000_000) * 50_000_000 * 1e-9
        row = angles(t) + speeds(t) + commands(held)
        file.write(f'{(ORIGIN + ns) // 10**9}.{(ORIGIN + ns) % 10**9:09},' + ','.join(map(repr, row)) + '\n')
