"""Link poses, Jacobians, inverse and forward dynamics, mass matrices and energies by Pinocchio, for `tests/dynamics`.

Run by hand, not by the tests:  pip install pin numpy;  python tests/oracle/dynamics.py > tests/oracle/dynamics.json

Robots: every URDF in `robots/`, and a random tree of revolute, continuous and prismatic joints with branches, loads on
fixed joints and mimics. Pinocchio's model has every joint free; where joints mimic others, positions, velocities and
accelerations are those that the gears give, q_bodies = G q + offsets, and forces and matrices are multiplied by G:
tau = G^T tau_bodies, M = G^T M_bodies G, J = J_bodies G. Forward dynamics is M^-1 (tau / 2 - bias) where there are gears, and
Pinocchio's articulated bodies where there are none. Rows of Jacobians: linear at the link's origin, then angular, in the
base's directions (LOCAL_WORLD_ALIGNED). No armature, friction or damping.
"""

import json
import pathlib
import sys
import xml.etree.ElementTree as xml

import numpy as np
import pinocchio as pin

CASES = 3
GRAVITY = 9.81
SEED = 20260


def tree(rng, joints=9):
    """A random URDF; what `undulate::testing::trees` draws, drawn again."""
    robot = xml.Element("robot", name="tree")
    xml.SubElement(robot, "link", name="link_0")

    def numbers(values):
        return " ".join(f"{x:.6g}" for x in values)

    def pose(parent):
        xml.SubElement(parent, "origin", xyz=numbers(rng.uniform(-0.4, 0.4, 3)), rpy=numbers(rng.uniform(-3, 3, 3)))

    def link(name):
        inertial = xml.SubElement(xml.SubElement(robot, "link", name=name), "inertial")
        pose(inertial)
        mass = rng.uniform(0.2, 5)
        x, y, z = mass / 12 * rng.uniform(0.1, 0.5, 3) ** 2
        xml.SubElement(inertial, "mass", value=f"{mass:.6g}")
        moments = {"ixx": y + z, "iyy": x + z, "izz": x + y, "ixy": 0, "ixz": 0, "iyz": 0}
        xml.SubElement(inertial, "inertia", {k: f"{v:.6g}" for k, v in moments.items()})

    for i in range(joints):
        link(f"link_{i + 1}")
        kind = ["revolute", "continuous", "prismatic"][i % 3]
        joint = xml.SubElement(robot, "joint", name=f"joint_{i}", type=kind)
        xml.SubElement(joint, "parent", link=f"link_{max(0, i - rng.integers(0, 3))}")
        xml.SubElement(joint, "child", link=f"link_{i + 1}")
        pose(joint)
        xml.SubElement(joint, "axis", xyz=numbers(rng.uniform(-1, 1, 3)))
        xml.SubElement(joint, "limit", lower="-3", upper="3", velocity="5", effort="50")
        if i in (4, 7):
            leader = {4: "joint_1", 7: "joint_4"}[i]
            xml.SubElement(joint, "mimic", joint=leader, multiplier=f"{rng.uniform(-2, 2):.6g}", offset="0.3")
        if i in (2, 6):
            link(f"load_{i}")
            mount = xml.SubElement(robot, "joint", name=f"mount_{i}", type="fixed")
            xml.SubElement(mount, "parent", link=f"link_{i + 1}")
            xml.SubElement(mount, "child", link=f"load_{i}")
            pose(mount)
    xml.indent(robot)
    return xml.tostring(robot, encoding="unicode")


def values(text, rng):
    root = xml.fromstring(text)
    mimics = {j.get("name"): j.find("mimic") for j in root.iter("joint") if j.find("mimic") is not None}
    for joint in root.iter("joint"):
        for mimic in joint.findall("mimic"):
            joint.remove(mimic)
    # Shapes are of no interest here.
    for link in root.iter("link"):
        for shape in link.findall("visual") + link.findall("collision"):
            link.remove(shape)
    model = pin.buildModelFromXML(xml.tostring(root, encoding="unicode"))
    model.gravity.linear[:] = [0, 0, -GRAVITY]
    data = model.createData()
    names = list(model.names)[1:]
    free = [n for n in names if n not in mimics]

    def gear(name):
        """The joint's row of G and its offset."""
        if name not in mimics:
            return np.array([float(n == name) for n in free]), 0.0
        mimic = mimics[name]
        row, offset = gear(mimic.get("joint"))
        multiplier = float(mimic.get("multiplier", 1))
        return multiplier * row, multiplier * offset + float(mimic.get("offset", 0))

    rows = [gear(n) for n in names]
    gears, offsets = np.array([r for r, _ in rows]), np.array([o for _, o in rows])

    def configuration(positions):
        """Pinocchio keeps continuous joints as cosine and sine."""
        q = pin.neutral(model)
        for joint, position in zip(model.joints[1:], positions):
            q[joint.idx_q : joint.idx_q + joint.nq] = (
                [position] if joint.nq == 1 else [np.cos(position), np.sin(position)]
            )
        return q

    # Joints are of one degree of freedom each, in the model's order of velocities.
    assert [j.idx_v for j in model.joints[1:]] == list(range(len(names)))
    zero = configuration(offsets)
    links = [l.get("name") for l in root.iter("link")]
    cases = []
    for _ in range(CASES):
        q, v, a = rng.uniform(-2, 2, len(free)), rng.uniform(-2, 2, len(free)), rng.uniform(-5, 5, len(free))
        full = configuration(gears @ q + offsets)
        mass = pin.crba(model, data, full)
        mass = np.triu(mass) + np.triu(mass, 1).T
        mass = gears.T @ mass @ gears
        tau = gears.T @ pin.rnea(model, data, full, gears @ v, gears @ a)
        bias = gears.T @ pin.rnea(model, data, full, gears @ v, 0 * (gears @ a))
        if mimics:
            forward = np.linalg.solve(mass, tau / 2 - bias)
        else:
            forward = pin.aba(model, data, full, gears @ v, gears @ (tau / 2))
        gravity = gears.T @ pin.computeGeneralizedGravity(model, data, full)
        kinetic = pin.computeKineticEnergy(model, data, full, gears @ v)
        potential = pin.computePotentialEnergy(model, data, full) - pin.computePotentialEnergy(model, data, zero)
        pin.framesForwardKinematics(model, data, full)
        pin.computeJointJacobians(model, data, full)
        poses, jacobians = {}, {}
        for link in links:
            frame = model.getFrameId(link)
            poses[link] = data.oMf[frame].homogeneous[:3].ravel().tolist()
            if link == links[-1] or link == links[len(links) // 2]:
                jacobian = pin.getFrameJacobian(model, data, frame, pin.ReferenceFrame.LOCAL_WORLD_ALIGNED)
                jacobians[link] = (jacobian @ gears).ravel().tolist()
        cases.append(
            {
                "q": q.tolist(),
                "v": v.tolist(),
                "a": a.tolist(),
                "link_pose_3x4_row_major": poses,
                "link_jacobian_row_major": jacobians,
                "rnea_tau": tau.tolist(),
                "mass_matrix": mass.ravel().tolist(),
                "aba_of_half_tau": forward.tolist(),
                "gravity_tau": gravity.tolist(),
                "kinetic_energy": float(kinetic),
                "potential_energy_above_zero": float(potential),
            }
        )
    return {"robot": root.get("name"), "joints_in_order_of_q": free, "cases": cases}


def main():
    rng = np.random.default_rng(SEED)
    entries = []
    for path in sorted((pathlib.Path(__file__).parents[2] / "robots").glob("*.urdf")):
        entries.append(values(path.read_text(), rng))
    text = tree(rng)
    entries.append({"urdf": text, **values(text, rng)})
    note = f"Pinocchio {pin.__version__}, tests/oracle/dynamics.py"
    json.dump({"from": note, "robots": entries}, sys.stdout, separators=(",", ":"))
    print()


if __name__ == "__main__":
    main()
