

def build():
    """Returns a builder with the scene: `model = build().finalize()`."""
    builder = newton.ModelBuilder(up_axis=newton.Axis.Z, gravity=GRAVITY)
    rods = [add_rod(builder, rod) for rod in RODS]
    for clamp in CLAMPS:
        body = builder.add_link(is_kinematic=True)
        attach(builder, rods, clamp, body)
    for load in MASSES:
        inertia = max(load["mass"] * RODS[load["rod"]]["radius"] ** 2, INERTIA)
        inertia = wp.mat33(inertia * np.eye(3))
        attach(builder, rods, load, builder.add_body(mass=load["mass"], inertia=inertia))
    for plane in PLANES:
        equation = (*plane["normal"], -np.dot(plane["normal"], plane["point"]))
        builder.add_shape_plane(equation, width=0.0, length=0.0, cfg=surface(plane["friction"]))
    for capsule in CAPSULES:
        ends = np.array(capsule["ends"])
        length = np.linalg.norm(ends[1] - ends[0])
        turn = wp.quat_identity()
        if length > 0.0:
            turn = wp.quat_between_vectors(wp.vec3(0, 0, 1), wp.vec3((ends[1] - ends[0]) / length))
        builder.add_shape_capsule(
            -1,
            xform=wp.transform(wp.vec3(ends.mean(axis=0)), turn),
            radius=capsule["radius"],
            half_height=0.5 * length,
            cfg=surface(capsule["friction"]),
        )
    builder.color()
    return builder


def surface(friction):
    """Returns the surface of a shape. Newton takes the geometric mean of two coefficients."""
    return newton.ModelBuilder.ShapeConfig(
        density=0.0, ke=CONTACT, kd=0.0, mu=friction, has_shape_collision=COLLIDE
    )


def lengths_of(rod):
    """Returns the lengths of the edges of a rod, m."""
    points = rod["points"] + rod["points"][:1] * rod["closed"]
    return np.linalg.norm(np.diff(points, axis=0), axis=1)


def add_rod(builder, rod):
    """Adds a rod; returns the bodies of its edges."""
    lengths = lengths_of(rod)
    shape = newton.Rod(
        rod["points"] + rod["points"][:1] * rod["closed"],
        closed=rod["closed"],
        rest_straight=rod["straight"] and len(lengths) > 1,
        radius=rod["radius"],
        stretch_rigidity=rod["EA"],
        shear_rigidity=rod["EA"],
        bend_rigidity=rod["EI"],
        twist_rigidity=rod["GJ"],
    )
    bodies, joints = builder.add_rod(rod=shape, cfg=surface(FRICTION), label=rod["name"])
    for body, length in zip(bodies, lengths):
        # A density would count the round ends of each capsule.
        mass = rod["mass"] * length
        across, along = max(mass * length**2 / 12, INERTIA), max(rod["spin"] * length, INERTIA)
        builder.body_mass[body], builder.body_inv_mass[body] = mass, 1 / mass
        builder.body_inertia[body] = wp.mat33(np.diag([across, across, along]))
        builder.body_inv_inertia[body] = wp.mat33(np.diag([1 / across, 1 / across, 1 / along]))
    for joint in joints:
        first = builder.joint_qd_start[joint]
        for axis in range(first + 3, first + 6):  # two of bending, one of twisting
            builder.joint_target_kd[axis] = rod["damping"] * builder.joint_target_ke[axis]
    # Edges nearer along the rod than the tightest half turn do not collide.
    shapes = [builder.body_shapes[body][0] for body in bodies]
    ends = np.cumsum(lengths)
    for one in range(len(shapes)):
        for other in range(one + 1, len(shapes)):
            gap = ends[other - 1] - ends[one]
            if rod["closed"]:
                gap = min(gap, ends[-1] - lengths[one] - lengths[other] - gap)
            if gap < math.pi * rod["radius"]:
                builder.add_shape_collision_filter_pair(shapes[one], shapes[other])
    return bodies


def attach(builder, rods, holder, body):
    """Attaches a body to a node; with half an edge in between if it holds the direction."""
    rod, edges, node = RODS[holder["rod"]], rods[holder["rod"]], holder["node"]
    edge = min(node, len(edges) - 1)
    half = 0.5 * lengths_of(rod)[edge]
    turn = wp.transform_get_rotation(builder.body_q[edges[edge]])
    if holder["tangent"]:
        along = wp.quat_rotate(turn, wp.vec3(0, 0, 1))
        turn = wp.quat_between_vectors(along, wp.vec3(holder["tangent"])) * turn
    builder.body_q[body] = wp.transform(wp.vec3(rod["points"][node]), turn)
    is_framed = 1.0 if holder["tangent"] else 0.0
    builder.add_joint_rod(
        parent=body,
        child=edges[edge],
        child_xform=wp.transform(wp.vec3(0, 0, half if node > edge else -half), wp.quat_identity()),
        rest_rotation=wp.quat_identity() if rod["straight"] else None,
        stretch_stiffness=rod["EA"] / half,
        bend_stiffness=is_framed * rod["EI"] / half,
        bend_damping=is_framed * rod["damping"] * rod["EI"] / half,
        twist_stiffness=is_framed * rod["GJ"] / half,
        twist_damping=is_framed * rod["damping"] * rod["GJ"] / half,
    )


@wp.kernel
def move(
    clock: wp.array[int],
    bodies: wp.array[int],
    placed: wp.array[wp.quat],
    first: wp.array[int],
    times: wp.array[float],
    path: wp.array[wp.transform],
    body_q: wp.array[wp.transform],
):
    """Moves each clamp to its place at the end of a step."""
    clamp = wp.tid()
    time = float(clock[0] + 1) * STEP
    after = int(first[clamp] + 1)
    while after < first[clamp + 1] - 1 and times[after] < time:
        after += 1
    share = wp.clamp((time - times[after - 1]) / (times[after] - times[after - 1]), 0.0, 1.0)
    one, other = path[after - 1], path[after]
    place = wp.lerp(wp.transform_get_translation(one), wp.transform_get_translation(other), share)
    turn = wp.quat_slerp(wp.transform_get_rotation(one), wp.transform_get_rotation(other), share)
    body_q[bodies[clamp]] = wp.transform(place, turn * placed[clamp])


@wp.kernel
def end_step(clock: wp.array[int], body_qd: wp.array[wp.spatial_vector]):
    """Counts the step, and slows bodies down."""
    body = wp.tid()
    body_qd[body] = body_qd[body] * wp.exp(-DRAG * STEP)
    if body == 0:
        clock[0] = clock[0] + 1


def simulate(model):
    """Yields the time, s, and the state, at time zero and after each interval."""
    device = model.device
    bodies = [model.body_count - len(MASSES) - len(CLAMPS) + clamp for clamp in range(len(CLAMPS))]
    moving = [(body, clamp["path"]) for body, clamp in zip(bodies, CLAMPS) if clamp["path"]]
    corners = [corner for _, path in moving for corner in path]
    placed = model.body_q.numpy()[[body for body, _ in moving], 3:]
    clock = wp.zeros(1, dtype=int, device=device)
    paths = [
        clock,
        wp.array([body for body, _ in moving], dtype=int, device=device),
        wp.array(placed, dtype=wp.quat, device=device),
        wp.array(np.cumsum([0] + [len(path) for _, path in moving]), dtype=int, device=device),
        wp.array([corner[0] for corner in corners], dtype=float, device=device),
        wp.array([corner[1:] for corner in corners], dtype=wp.transform, device=device),
    ]
    pipeline = newton.CollisionPipeline(model) if COLLIDE else None
    contacts = pipeline.contacts() if COLLIDE else None
    solver = newton.solvers.SolverVBD(model, iterations=ITERATIONS)
    states, control = [model.state(), model.state()], model.control()

    def two_steps():
        for before, after in [states, states[::-1]]:
            if moving:
                wp.launch(move, len(moving), [*paths, before.body_q], device=device)
            before.clear_forces()
            if COLLIDE:
                pipeline.collide(before, contacts)
            solver.step(before, after, control, contacts, STEP)
            wp.launch(end_step, model.body_count, [clock, after.body_qd], device=device)

    yield 0.0, states[0]
    two_steps()  # reserves memory
    with wp.ScopedCapture(device=device) as capture:
        two_steps()
    step = int(clock.numpy()[0])
    while step < STEPS:
        wp.capture_launch(capture.graph)
        step += 2
        if step % OUTPUT_EVERY == 0:
            yield step * STEP, states[0]


def positions(state):
    """Returns the positions of the nodes of each rod, m."""
    poses, rods, first = state.body_q.numpy(), [], 0
    for rod in RODS:
        lengths = lengths_of(rod)
        edges = poses[first : first + len(lengths)]
        first += len(lengths)
        x, y, z, w = edges[:, 3:].T
        tangents = np.array([2 * (x * z + w * y), 2 * (y * z - w * x), 1 - 2 * (x * x + y * y)]).T
        starts = edges[:, :3] - 0.5 * lengths[:, None] * tangents
        ends = edges[:, :3] + 0.5 * lengths[:, None] * tangents
        if rod["closed"]:
            rods.append(0.5 * (starts + np.roll(ends, 1, axis=0)))
        else:
            rods.append(np.vstack([starts[:1], 0.5 * (starts[1:] + ends[:-1]), ends[-1:]]))
    return rods


if __name__ == "__main__":
    wp.config.log_level = wp.LOG_ERROR  # only the table goes to standard output
    print("time_s,rod,node,x_m,y_m,z_m")
    for time, state in simulate(build().finalize()):
        for rod, nodes in zip(RODS, positions(state)):
            for node, (x, y, z) in enumerate(nodes):
                print(f"{time:.6g},{rod['name']},{node},{x:.7g},{y:.7g},{z:.7g}", flush=True)
