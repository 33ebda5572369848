"""A row of results of a mechanism, by the names of the command's columns."""

import numpy as np

from mechanism.rotations import vector_of

LETTERS = ["x", "y", "z", "rx", "ry", "rz"]
PLANE_MOUNT = ["force_x [N]", "force_y [N]", "moment [N m]"]
SPACE_MOUNT = ["force_x [N]", "force_y [N]", "force_z [N]", "moment_x [N m]", "moment_y [N m]", "moment_z [N m]"]


def motion(march, state, a):
    """Places, velocities and accelerations of every coordinate."""
    m, row = march.model, {}
    turned = vector_of(state.q) if m.space else np.stack([0 * state.angle, 0 * state.angle, state.angle], axis=1)
    for k, c in enumerate(m.free):
        p, i = divmod(int(c), 6)
        name = f"{m.names[p]}.{LETTERS[i]}"
        if i < 3:
            row[f"{name}.position [m]"] = state.r[p, i]
            row[f"{name}.velocity [m/s]"] = state.u[k]
            row[f"{name}.acceleration [m/s2]"] = a[k]
        else:
            row[f"{name}.angle [rad]"] = turned[p, i - 3]
            row[f"{name}.angular_velocity [rad/s]"] = state.u[k]
            row[f"{name}.angular_acceleration [rad/s2]"] = a[k]
    return row


def wrench(march, state, mu, derivatives, joint, numbers):
    """Force and moment, by the axes of the world, of these rows on the joint's second part, about its point there."""
    b = joint.second
    line = mu[numbers] @ derivatives[numbers][:, 6 * b : 6 * b + 6]
    force, moment = line[:3], state.R[b] @ line[3:]
    return force, moment - np.cross(state.R[b] @ joint.arm2, force)


def derivatives_of_all(march, state, maps):
    """The rows' derivatives by the motions of all parts, held ones too."""
    m = march.model
    free, nf = m.free, m.nf
    n = 6 * len(m.names)
    kept = state.u
    full = np.zeros(n)
    full[free] = kept
    m.free, m.nf = np.arange(n), n
    state.u = full
    try:
        dS = m.scalars(state)[1]
    finally:
        m.free, m.nf = free, nf
        state.u = kept
    return maps @ dS


def joints(march, state, t, kin, a, mu):
    m, row = march.model, {}
    S, dS, S1, S2 = kin
    ways, rates, second = m.way_map @ S + m.way_constant, m.way_map @ S1, m.way_map @ (dS @ a + S2)
    full = derivatives_of_all(march, state, m.row_map)
    at = len(m.row_map)
    drive_mu = {}
    for j in march.drives:
        drive_mu[j.name] = mu[at]
        at += 1
    lock_mu = {}
    for l in march.locks:
        if l.held and l.rigid:
            lock_mu[l.joint.name] = lock_mu.get(l.joint.name, 0.0) + mu[at]
            at += 1
    holds = {}
    for d in march.dry:
        if d.going is None and not d.resting:
            holds[id(d)] = mu[at : at + len(d.maps)]
            at += len(d.maps)
    if m.beams:
        sections(march, state, row)
    for j in m.joints:
        for k in ([j.way] if j.way is not None else []) + j.ways:
            c = m.coordinates[k]
            if c.kind == "angle":
                row[f"{j.name}.angle [rad]"] = ways[k]
                row[f"{j.name}.angular_velocity [rad/s]"] = rates[k]
                row[f"{j.name}.angular_acceleration [rad/s2]"] = second[k]
            elif c.kind in ("displacement", "length"):
                row[f"{j.name}.displacement [m]"] = ways[k]
                row[f"{j.name}.velocity [m/s]"] = rates[k]
                row[f"{j.name}.acceleration [m/s2]"] = second[k]
        if j.type == "screw":
            row[f"{j.name}.displacement [m]"] = m.thread_map[j.name][1] @ S
        if j.row_numbers:
            force, moment = wrench(march, state, mu, full, j, j.row_numbers)
            if j.type == "distance":
                row[f"{j.name}.reaction_tension [N]"] = -mu[j.row_numbers[0]]
            elif m.space:
                for i, letter in enumerate("xyz"):
                    row[f"{j.name}.reaction_{letter} [N]"] = force[i]
                for i, letter in enumerate("xyz"):
                    row[f"{j.name}.reaction_moment_{letter} [N m]"] = moment[i]
            elif j.type == "prismatic":
                row[f"{j.name}.reaction_normal [N]"] = mu[j.row_numbers[0]]
                row[f"{j.name}.reaction_moment [N m]"] = moment[2]
            else:
                row[f"{j.name}.reaction_x [N]"] = force[0]
                row[f"{j.name}.reaction_y [N]"] = force[1]
                if j.type == "rigid":
                    row[f"{j.name}.reaction_moment [N m]"] = moment[2]
        turning = j.way is not None and m.coordinates[j.way].turning
        unit, what = ("[N m]", "moment") if turning else ("[N]", "force")
        if j.name in drive_mu:
            row[f"{j.name}.drive_{what} {unit}"] = drive_mu[j.name]
        if any(lock["stiffness"] == 0 for lock in j.locks):
            row[f"{j.name}.reaction_lock_{what} {unit}"] = lock_mu.get(j.name, 0.0)
        if j.way is not None and (j.stiffness or j.damping or j.formula is not None or j.points is not None
                                  or any(lock["stiffness"] for lock in j.locks)):
            row[f"{j.name}.law_{what} {unit}"] = march.law_force.get(j.name, 0.0)
    for gear in m.gears:
        turning = m.coordinates[gear.first.way].turning
        row[f"{gear.name}.reaction_gear_{'moment [N m]' if turning else 'force [N]'}"] = mu[gear.row]
    for b, told in zip(m.bushings, march.mount_told):
        for name, value in zip(SPACE_MOUNT if m.space else PLANE_MOUNT, told):
            row[f"{b.name}.{name}"] = value
    for d in march.dry + march.immobile:
        if d.resting or d in march.immobile:
            force = np.zeros(len(d.maps))
        elif d.going is None:
            force = holds[id(d)]
        else:
            slip = d.maps @ S1
            size = np.linalg.norm(slip)
            way = d.going if len(d.maps) == 1 or d.fresh or size == 0 else slip / size
            force = -d.limit_now * way
        j = d.joint
        if j.type in ("revolute", "screw", "universal"):
            row[f"{d.names[0]}.friction_moment [N m]"] = force[0] * d.scale[0]
        elif j.type == "cylindrical":
            row[f"{j.name}.friction_force [N]"] = force[0]
            row[f"{j.name}.friction_moment [N m]"] = force[1] * d.scale[1]
        elif j.type == "planar":
            world = state.R[j.first] @ m.start_R[j.first].T @ j.frame[:, :2] @ force
            for i, letter in enumerate("xyz"):
                row[f"{j.name}.friction_force_{letter} [N]"] = world[i]
        else:
            row[f"{j.name}.friction_force [N]"] = force[0]
    return row


def sections(march, state, row):
    """Section forces in the middle of each part of each beam, those of a retardation time included."""
    m = march.model
    strain, _, rates = m.beam_state(state)
    stress = m.bC * (strain + m.btau[:, None] * rates)
    for beam, s in zip(m.beams, stress):
        name = f"{beam['name']}({beam['index']})"
        row[f"{name}.normal_force [N]"] = s[0]
        if m.space:
            row[f"{name}.shear_force_y [N]"], row[f"{name}.shear_force_z [N]"] = s[1], s[2]
            row[f"{name}.torsion [N m]"] = s[3]
            row[f"{name}.bending_moment_y [N m]"], row[f"{name}.bending_moment_z [N m]"] = s[4], s[5]
        else:
            row[f"{name}.shear_force [N]"] = s[1]
            row[f"{name}.bending_moment [N m]"] = s[5]


def transient_row(march, state, t, works):
    m = march.model
    kin = m.scalars(state)
    a, mu, _ = march.instant(state, t, kin)
    row = {"time [s]": t}
    row.update(motion(march, state, a))
    shared = march.undetermined or march.immobile
    row.update(joints(march, state, t, kin, a, mu))
    if shared:      # of reactions that joints share nothing is asked
        row.update({k: np.nan for k in row if k.endswith("[N]") or k.endswith("[N m]")})
    laws(march, works, row)
    _, tally = march.applied(state, t, kin, tally=True)
    energy = {"time [s]": t, "kinetic [J]": march.kinetic(state), "strain [J]": tally["stored"],
              "damper_dissipated [J]": works[0], "friction_dissipated [J]": works[1], "lock_dissipated [J]": march.lost,
              "load_work [J]": works[2], "drive_work [J]": works[3]}
    if m.local_laws:
        energy["law_stored [J]"] = sum(law.stored(u, z) for law, (u, _, _, z) in zip(m.local_laws, march.local_told))
        energy["law_dissipated [J]"] = sum(works[4:])
    return row, energy


def laws(march, works, row):
    """By either name of what turns."""
    for law, (u, _, f, _), lost in zip(march.model.local_laws, march.local_told, works[4:]):
        for quantity in ("force [N]", "moment [N m]") if law.rotation else ("force [N]",):
            row[f"{law.name}.{quantity}"] = f
        for quantity in ("displacement [m]", "angle [rad]", "relative_angle [rad]") if law.rotation else ("displacement [m]",):
            row[f"{law.name}.{quantity}"] = u
        row[f"{law.name}.dissipated [J]"] = lost
