"""`BodyPhysics`: physics of a robot's body, independent of its cable network."""

from functools import cached_property
from itertools import chain
from typing import Any

import numpy as np

from hydrostat.arrays import Float, Nodes, Points, Vector
from hydrostat.errors import InputError
from hydrostat.given import check_type
from hydrostat.mechanics import (
    PATCH_SIZE,
    Assembly,
    DeadLoadEnergy,
    Energy,
    Factorization,
    FoamSolid,
    FrictionalSelfContactEnergy,
    GuideEnergy,
    InversionBarrier,
    NeoHookean,
    ObstacleEnergy,
    PatchDilatation,
    PinEnergy,
    PrandtlEnergy,
    QuadraticSolid,
    RigidBodyDofs,
    RigidBodyWarp,
    RigidEnergy,
    RoundOff,
    SelfContactEnergy,
    StepMap,
    Warp,
    grow_patches,
)
from hydrostat.robot import Body, Obstacle, Plane, Robot, Volume, check_winch_bodies
from hydrostat.simulation.load_energies import hung_masses, make_load_energies
from hydrostat.simulation.reinforcements import make_rod_energies, make_sheet_energies, sheet_masses


class BodyPhysics:
    """Elastic body, pins and weight of a robot: energies, sparse pattern, factors at rest, steps along arcs.

    It is made once for a body and never changes, so all simulations of networks on it share it, in all threads.
    Statics has no time, so obstacles with a path stand still there; physics in time have them among the unknowns.

    Attributes:
        elastic: elastic energy of the body, of linear or quadratic elements; includes the resistance to volume change,
            unless patches measure that.
        pins: energy of the pins, one support for each pin.
        assembly: sum of all energies of the body; they read no control.
        material: material of the body.
        thickness: thickness of a flat body [m]; None in space.
        masses: lumped mass of each node [kg], (nodes,): each element shares its mass evenly among its corners, a hung
            mass by its anchor.
        inertias: mass of each unknown in motion [kg], (rows,).
        rigid_dofs: rows of the unknowns of moving obstacles, by index of the obstacle.
        guides: index of each energy that keeps an obstacle on its path, with the obstacle.
        load_paths: index of each energy of a load that varies in time, with the load.
        own_contact: index of the self-contact energy among all energies of a simulation; None if self-contact is
            disabled.
        obstacles: indices of the energies of the obstacles.
        rods: energy of each rod.
        sheets: energies of each sheet.
        rest_unknowns: all unknowns at rest [m], (rows, dim): the nodes, then the rows of the moving obstacles.
    """

    def __init__(self, robot: Robot, *, in_time: bool = False) -> None:
        """Physics of the body of `robot`; its network does not matter; `in_time` obstacles move along their paths.

        Raises:
            InputError: no robot, or a part of the mesh that no pin holds.
        """
        check_type(robot, Robot, "a simulation is of a Robot, such as load_robot gives")
        check_winch_bodies(robot)
        body = robot.body
        self._given = body, *_list_given(robot)
        self.material, self.thickness = body.material, body.thickness
        mesh, solid = body.mesh, ~body.element_foams
        lame = np.where(solid, body.lame()[1], 0.0)
        self.rigid_dofs = _rigid_dofs(robot, in_time=in_time)
        moving = [carriage.unknowns(*_begin(robot.obstacles[index])) for index, carriage in self.rigid_dofs.items()]
        self.rest_unknowns = np.concatenate([mesh.nodes, *moving]) if moving else mesh.nodes
        patched = body.volume is Volume.PATCH
        self.elastic = _elastic(robot, self.rest_unknowns, None if patched else lame)
        if body.plane is Plane.STRESS:
            self.elastic = self.elastic.as_plane_stress()
        self.pins = _pins(robot)
        carried = [_obstacle_masses(robot.obstacles[index], carriage) for index, carriage in self.rigid_dofs.items()]
        self.sheets = [make_sheet_energies(robot, sheet, self.rest_unknowns) for sheet in robot.sheets]
        own, hung = _masses(robot) + sheet_masses(robot, self.sheets), hung_masses(robot)
        self.masses, self._hung = own + hung, hung
        self.inertias = np.concatenate([self.masses, *carried]) if carried else self.masses
        energies: list[Energy] = [self.elastic, self.pins]
        if patched and solid.any():
            elements, kinds = mesh.elements[solid], body.element_materials[solid]
            patches = grow_patches(elements, PATCH_SIZE[mesh.dim], kinds)
            given = {"lame": lame[solid], "thickness": _depths(body)[solid], "materials": kinds}
            energies.append(PatchDilatation(self.rest_unknowns, elements, patches, **given))
        energies += _foams(robot, self.elastic, self.rest_unknowns)
        energies += _sliders(robot, self.elastic, self.rest_unknowns)
        energies += _barriers(body, self.elastic, self.rest_unknowns)
        if robot.gravity is not None:
            energies.append(DeadLoadEnergy(self.rest_unknowns, self._heavy[:, None] * np.array(robot.gravity)))
        rods = [make_rod_energies(robot, rod, self.rest_unknowns) for rod in robot.rods]
        self.rods, self.twists = [bent for bent, _ in rods], [twist for _, twist in rods]
        self._reinforcements = [*self.rods, *filter(None, self.twists), *chain.from_iterable(self.sheets)]
        energies += self._reinforcements
        loads, paths = make_load_energies(robot, self.rest_unknowns)
        self.load_paths = {len(energies) + index: load for index, load in paths.items()}
        energies += loads
        self.own_contact = None if robot.contact is None else len(energies)
        if robot.contact is not None:
            own = SelfContactEnergy.of(mesh, **_contact_parameters(robot), rest=self.rest_unknowns)
            rubs = robot.contact.friction
            energies.append(FrictionalSelfContactEnergy.of(mesh, own, rubs) if rubs else own)
        self.obstacles, self.guides = [], dict[int, Obstacle]()
        for index, obstacle in enumerate(robot.obstacles):
            self.obstacles.append(len(energies))
            if index in self.rigid_dofs and obstacle.path:
                self.guides[len(energies) + 1] = obstacle
            energies += self._obstacle_energies(robot, obstacle, self.rigid_dofs.get(index))
        self.assembly = Assembly(energies, rest=self.rest_unknowns, control_count=0)

    @property
    def node_count(self) -> int | None:
        """Number of unknowns that are nodes of the body; None if all are."""
        return len(self._given[0].mesh.nodes) if self.rigid_dofs else None

    def fits(self, robot: Robot) -> bool:
        """Return True if this is the physics of a robot's body: same body, equal pins, gravity, contact and loads."""
        body, *others = self._given
        return robot.body is body and _list_given(robot) == others

    def check(self, robot: Robot) -> None:
        """Check that this is the physics of the body of a robot.

        Raises:
            InputError: it is that of another body, of other pins or of another gravity.
        """
        if not self.fits(robot):
            raise InputError("these body physics are of another body, pins, gravity, contact or loads; make new ones")

    @property
    def heavy_masses(self) -> Float[np.ndarray, " rows"]:
        """Masses that gravity pulls at, hung ones too [kg]."""
        heavy = self._heavy
        heavy[: len(self._hung)] += self._hung
        return heavy

    @property
    def _heavy(self) -> Float[np.ndarray, " rows"]:
        """Masses that gravity pulls at: not the axes of obstacles, which are at their middle, nor loads."""
        heavy = self.inertias.copy()
        heavy[: len(self._hung)] -= self._hung
        for carriage in self.rigid_dofs.values():
            heavy[carriage.rows[1:]] = 0.0
        return heavy

    def check_held(self, start: Nodes | None = None, *, guided: bool = False) -> None:
        """Check that pins hold the body, and that something holds obstacles that move.

        Args:
            start: all unknowns where a solve begins [m]; at rest if left out.
            guided: True if other energies hold the obstacles.

        Raises:
            InputError: no pin, so it moves before friction on the ground can hold it; or an obstacle floats.
        """
        where, (_, _, _, _, obstacles, *_) = self.rest_unknowns if start is None else start, self._given
        for index in () if guided else self.rigid_dofs:
            met = self.assembly.energies[self.obstacles[index]]
            if not met.push(where).any():  # type: ignore[attr-defined]
                raise InputError(
                    f'nothing holds "{obstacles[index].name}", which has a mass: let it move in time (`hydrostat '
                    f"simulate --dynamic`), grasp it (`hydrostat grasp`), or remove its mass and it stands still"
                )
        if not self._given[1]:
            raise InputError(
                "no pin holds the robot: where it comes to rest on the ground depends on how it gets there, so let it "
                "move (`hydrostat simulate --dynamic`, or `Simulation.play`), or pin it"
            )

    def _obstacle_energies(self, robot: Robot, obstacle: Obstacle, carriage: RigidBodyDofs | None) -> list[Energy]:
        """Return the contact energy of an obstacle and the energy that keeps a moving one rigid or on its path."""
        field = (obstacle if carriage is None or obstacle.path else obstacle.to_own_frame()).field()
        friction = robot.friction_of(obstacle)
        met = ObstacleEnergy(robot.body.mesh, field, **_contact_parameters(robot), friction=friction, carriage=carriage)
        met, rigid = met.with_friction_at_rest(self.rest_unknowns), _RIGID * robot.body.material.young
        if carriage is None:
            return [met]
        if not obstacle.path:
            return [met, RigidEnergy(carriage, rigid * carriage.length**3)]
        place, axes = _begin(obstacle)
        stiffness = rigid * carriage.length
        return [met, GuideEnergy(carriage, place=place, axes=axes, along=stiffness * axes, turning=stiffness)]

    @cached_property
    def warp(self) -> StepMap:
        """Steps along arcs."""
        if not self.rigid_dofs:
            return self._body_warp
        return RigidBodyWarp(self._body_warp, len(self._given[0].mesh.nodes), tuple(self.rigid_dofs.values()))

    @cached_property
    def _body_warp(self) -> Warp:
        mesh, (mu, _) = self._given[0].mesh, self._given[0].lame()
        shape = NeoHookean(mesh.nodes, mesh.elements, mu=0.0, lame=0.0, thickness=self.thickness or 1.0)
        return Warp(
            stencils=shape.stencils,
            shape_gradients=shape.shape_gradients,
            volumes=shape.volumes * (mu / self.material.lame[0]),  # the stiffer a part, the more exactly it turns
            rest=mesh.nodes,
            held=self.pins.stencils,
            holds=self.pins.weights,
        )

    @cached_property
    def rest_factors(self) -> Factorization:
        """Hessian of the body at rest, factorized; cables that do not pull add nothing to it."""
        return self.assembly.with_active_terms(self.rest_unknowns).stiffness(self.rest_unknowns, np.zeros(0)).factors

    def round_off(self, stiffest: float = 0.0) -> RoundOff:
        """Rounding errors of the body's own forces, and of springs up to `stiffest` [N/m]."""
        scale, reach, springs, size = self._scales
        force = 1e-14 * scale / size * (reach / size) + 2e-16 * max(springs, stiffest) * reach
        return RoundOff(force=force, energy=1e-15 * scale)

    @cached_property
    def _scales(self) -> tuple[float, float, float, float]:
        """Modulus x volume [J], largest coordinate [m], stiffest pin [N/m], size [m]."""
        body, pins, *_ = self._given
        mu, lame = body.lame()
        scale = float((2 * mu + lame) @ body.mesh.volumes) * (body.thickness or 1.0)
        reach = max(float(np.abs(body.mesh.nodes).max()), body.mesh.size)
        springs = [pin.stiffness for pin in pins]
        springs += [energy.stiffest for energy in self._reinforcements]
        rigid = np.isin(body.element_materials, [i for i, part in enumerate(body.parts, start=1) if part.is_rigid])
        springs += _spring_rates(body, rigid).tolist()
        lengths = [carriage.length for carriage in self.rigid_dofs.values()]  # of axes, at which A A^T - I pulls
        springs += [2 * _RIGID * body.material.young * length * max(1.0, length / reach) for length in lengths]
        return scale, reach, max(springs, default=0.0), body.mesh.size


def _list_given(robot: Robot) -> list[Any]:
    """All that the physics of a body depend on but the body."""
    return [robot.pins, robot.gravity, robot.contact, robot.obstacles, robot.loads, robot.rods, robot.sheets]


def _depths(body: Body) -> Vector:
    """Thickness of each element [m], 1 in space, times the factor of its moduli."""
    return (body.thickness or 1.0) * body.stiffness_factors


def _spring_rates(body: Body, chosen: np.ndarray) -> Vector:
    """Five times the largest stiffness of some elements at a corner [N/m]: as many meet there."""
    mesh, (mu, lame) = body.mesh, body.lame()
    corners = mesh.nodes[mesh.elements[chosen]]
    inverse = np.linalg.inv(corners[:, 1:] - corners[:, :1])
    derivatives = np.concatenate([inverse, -inverse.sum(axis=2, keepdims=True)], axis=2)  # of the shape functions
    steepest = (derivatives**2).sum(axis=1).max(axis=1, initial=0.0)
    return 5 * (2 * mu + lame)[chosen] * mesh.volumes[chosen] * (body.thickness or 1.0) * steepest


def _elastic(robot: Robot, rest: Nodes, lame: Vector | None) -> NeoHookean | QuadraticSolid:
    """Elastic energy of the body but for foams; without resistance to a change of volume if `lame` is None."""
    body = robot.body
    mesh, mu = body.mesh, np.where(body.element_foams, 0.0, body.lame()[0])
    kinds = {"thickness": _depths(body), "materials": body.element_materials}
    if mesh.quadratic is None:
        return NeoHookean(rest, mesh.elements, mu=mu, lame=lame, **kinds)
    each = slice(None, None, 2**mesh.dim)  # the first part of each quadratic element
    kinds = {name: values[each] for name, values in kinds.items()}
    squeeze = None if lame is None else lame[each]
    return QuadraticSolid(rest, mesh.quadratic, mu=mu[each], lame=squeeze, **kinds)


def _foams(robot: Robot, elastic: NeoHookean | QuadraticSolid, rest: Nodes) -> list[FoamSolid]:
    """Elastic energy of each material with a foam law."""
    found, body, count = [], robot.body, len(elastic.stencils)
    gradients, volumes = (
        each.reshape(count, -1, *each.shape[1:]) for each in (elastic.point_gradients, elastic.volumes)
    )
    for index, material in enumerate(body.materials):
        own = elastic.materials == index
        if not material.foam or not own.any():
            continue
        terms = tuple((term.share, term.exponent) for term in material.foam)
        given = {"lame": material.lame, "terms": terms, "material": index, "is_free_across": body.plane is Plane.STRESS}
        points = {"gradients": gradients[own], "volumes": volumes[own]}
        found.append(FoamSolid(rest, elastic.stencils[own], **points, **given))
    return found


def _sliders(robot: Robot, elastic: NeoHookean | QuadraticSolid, rest: Nodes) -> list[PrandtlEnergy]:
    """Hysteresis of each material."""
    found, count = [], len(elastic.stencils)
    gradients, volumes = (
        each.reshape(count, -1, *each.shape[1:]) for each in (elastic.point_gradients, elastic.volumes)
    )
    for index, material in enumerate(robot.body.materials):
        own = elastic.materials == index
        for slider in material.hysteresis if own.any() else ():
            points = {"gradients": gradients[own], "volumes": volumes[own]}
            found.append(PrandtlEnergy(rest, elastic.stencils[own], **points, young=slider.young, strain=slider.strain))
    return found


def _barriers(body: Body, elastic: NeoHookean | QuadraticSolid, rest: Nodes) -> list[InversionBarrier]:
    """Barrier against the inversion of quadratic elements; none is needed for linear ones, whose J is constant."""
    if body.mesh.quadratic is None:
        return []
    mu, volumes = body.lame()[0][:: 2**body.mesh.dim], elastic.volumes.reshape(len(elastic.stencils), -1).sum(axis=1)
    return [InversionBarrier(rest, elastic.stencils, mu=mu, volumes=volumes, materials=elastic.materials)]


def _contact_parameters(robot: Robot) -> dict[str, Any]:
    """Return the contact parameters of the body's surface."""
    body = robot.body
    return {"distance": robot.contact_distance, "young": body.material.young, "thickness": body.thickness}


def _rigid_dofs(robot: Robot, *, in_time: bool) -> dict[int, RigidBodyDofs]:
    """Rows of the unknowns of obstacles that move, after those of the nodes: first of those with a mass."""
    rigid_dofs, row, mesh = {}, len(robot.body.mesh.nodes), robot.body.mesh
    for index, obstacle in enumerate(robot.obstacles):
        if obstacle.mass is not None:
            rigid_dofs[index] = RigidBodyDofs(row, 2 * float(np.sqrt(obstacle.second_moments().max())), mesh.dim)
            row += 1 + mesh.dim
    for index, obstacle in enumerate(robot.obstacles):
        if in_time and obstacle.path:
            rigid_dofs[index] = RigidBodyDofs(row, mesh.size, mesh.dim)
            row += 1 + mesh.dim
    return rigid_dofs


def _begin(obstacle: Obstacle) -> tuple[Vector, Points]:
    """Frame of an obstacle at rest; that of the world, if it has a path, along which this frame is shifted."""
    dim = len(obstacle.at)
    return (np.zeros(dim), np.eye(dim)) if obstacle.path else obstacle.frame()


def _obstacle_masses(obstacle: Obstacle, carriage: RigidBodyDofs) -> Float[np.ndarray, " rows"]:
    """Masses of the rows of an obstacle that moves [kg]: its own, then that of each of its axes."""
    if obstacle.mass is None:
        return np.zeros(1 + len(obstacle.at))
    return obstacle.mass * np.append(1.0, obstacle.second_moments() / carriage.length**2)


def _masses(robot: Robot) -> Float[np.ndarray, " nodes"]:
    elements = robot.body.mesh.elements
    shares = np.repeat(robot.body.element_masses / elements.shape[1], elements.shape[1])
    return np.bincount(elements.ravel(), shares, len(robot.body.mesh.nodes))


def _pins(robot: Robot) -> PinEnergy:
    """Pins, each at the points that it holds."""
    nodes = robot.body.mesh.nodes
    if not robot.pins and not robot.body.mesh.parts.any():
        none = np.zeros((0, 1))
        return PinEnergy(
            stencils=none.astype(np.int64), weights=none, targets=np.zeros((0, nodes.shape[1])), stiffness=none[:, 0]
        )
    anchors = [pin.anchors(robot.body.mesh) for pin in robot.pins]
    parts = robot.body.mesh.parts
    loose = np.setdiff1d(parts, [parts[node] for held in anchors for node in held.stencils[:, 0]])
    if loose.size:
        raise InputError(
            f"body: {loose.size} of the {parts.max() + 1} parts of the mesh are held by no pin, the first has "
            f"{int((parts == loose[0]).sum())} nodes; join them to the rest (merge nodes at one place) or pin them"
        )
    return PinEnergy(
        stencils=np.concatenate([held.stencils for held in anchors]),
        weights=np.concatenate([held.weights for held in anchors]),
        targets=np.concatenate([held.positions(nodes) for held in anchors]),
        stiffness=np.concatenate(
            [
                np.full(len(held.stencils), pin.stiffness / len(held.stencils))
                for pin, held in zip(robot.pins, anchors, strict=True)
            ]
        ),
        supports=np.repeat(np.arange(len(anchors)), [len(held.stencils) for held in anchors]),
    )


_RIGID = 1e3
"""Stiffness of what keeps obstacles rigid, in units of Young's modulus of the body times their length cubed."""
