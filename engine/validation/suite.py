"""All checks at full size, in the order of the document."""

from collections.abc import Callable
from dataclasses import dataclass
from functools import partial

from . import bodies, cylinder, environments, flows, gradients, shapes, sheet, sweep, swimmers
from .rows import Result


@dataclass(frozen=True)
class Check:
    """A measurement, which takes a `path` unless JAX alone can carry it out."""

    measure: Callable[..., Result]
    lacking: str = ""
    """The reason why the kernel cannot, as a sentence of the document."""


@dataclass(frozen=True)
class Section:
    """A section of the document: its title, its text and its checks."""

    title: str
    text: str
    checks: tuple[Check, ...]


FLOAT64 = "The kernel does not run the lines in float64: it calculates in float32."

SECTIONS = (
    Section(
        "Flows in closed form",
        "The fluid of a world whose body goes with the flow and exerts no force; in "
        "Kolmogorov flow the fluid alone. With Λ = 3/16 steady errors do not depend on "
        "viscosity; the default caps Λ at (τ − 1/2)/2, which moving bodies need below ν of "
        "about 0.01, and pays with errors that depend on τ below 0.875. A shear wave is "
        "unsteady: its error is bounded by 1.2 τ ν k², because the method needs τ ν k² to be "
        "small.",
        (
            Check(flows.check_shear_wave),
            Check(
                flows.check_kolmogorov,
                "The kernel does not run the fluid alone: see the flows of a world below.",
            ),
            Check(flows.check_taylor_green),
        ),
    ),
    Section(
        "Walls",
        "Halfway bounce-back, the fluid driven from rest by a uniform force until it is "
        "steady, 31 cells between the walls, around a body that exerts no force. The walls "
        "are where the parabola through the velocities vanishes. In float32 a step may round "
        "the velocity by 2⁻²³ of it. That acts as a force would, and the driving force is 8 ν "
        "/ 31² of the velocity, so the bar is the quotient of both.",
        (
            Check(flows.check_poiseuille, FLOAT64),
            Check(partial(flows.check_poiseuille, dtype="float32")),
        ),
    ),
    Section(
        "Flows of a world",
        "The flows that a spec offers, in 64 × 64 cells, started in their steady state and "
        "kept up by their force, Λ capped as for creatures; then bodies that they carry: a "
        "ring where the shear is strongest, and two nodes between the wall and the middle of "
        "a channel.",
        (Check(environments.check_flows), Check(environments.check_carried)),
    ),
    Section(
        "Conservation",
        "From random populations in 64 × 64 cells, around a body that exerts no force. "
        "Momentum is measured against the number of cells times 0.01.",
        (Check(flows.check_conservation),),
    ),
    Section(
        "An array of cylinders",
        "Nodes held still, by a limit of 0 cells a step, in a periodic box of 64 × 64 cells "
        "by multi-direct forcing, the flow driven by a uniform force. The four-point delta "
        "makes a cylinder thicker than the circle of its nodes, by 0.5 to 0.7 cells of "
        "radius, and this is the whole error: it falls with the radius. Bars are 20 %, and 10 "
        "% for the largest.",
        (Check(cylinder.check_array),),
    ),
    Section(
        "An array of posts",
        "Solid discs as obstacles of a world, in a periodic box of 64 × 64 cells, the flow "
        "driven by a uniform force. The surface of the solid cells is a staircase.",
        (Check(environments.check_posts),),
    ),
    Section(
        "A cylinder in a free stream",
        "Sixteen cells across, in 40 × 30 diameters of periodic box, with a sponge across"
        " the seam; Mach 0.14. The diameter in all numbers is that of the nodes and 0.8 "
        "cells. Drag is high by what the images of the cylinder block: in 25 × 20 "
        "diameters it is 8 % above the published value at Reynolds 20.",
        (Check(cylinder.check),),
    ),
    Section(
        "Passive bodies",
        "A ring and a rod that keep their shape, where the shear of a decaying sine flow is "
        "strongest.",
        (Check(bodies.check_passive),),
    ),
    Section(
        "Taylor's swimming sheet",
        "A prescribed transverse wave along a sheet that spans the box, free of net force; "
        "its speed against the fluid half a box away. The body is this sheet and its mirror "
        "image in a second box above, which keeps it from turning. Theory is the fourth order "
        "of Taylor with Tuck's factor for inertia (R = 0.4). The delta makes the sheet "
        "thicker: an error of first order in cells over wavelength.",
        (Check(sheet.check),),
    ),
    Section(
        "Swimmers",
        "The worm's second cycle against a Fourier solution of Stokes flow in the same "
        "box by the same shapes, and at other node spacings; the ray, whose motion is "
        "reciprocal; and the five known swimmers' net impulse, the largest sum of forces "
        "accumulated over two cycles, limits on.",
        (
            Check(swimmers.check_worm),
            Check(swimmers.check_spacing),
            Check(swimmers.check_scallop),
            Check(swimmers.check_impulse),
        ),
    ),
    Section(
        "Shapes",
        "Constraint projection in one step without a fluid: a straight chain of 32 nodes that "
        "is to close into a circle, and the ciliate (a ring with six hairs) from nodes "
        "displaced at random by 0.3 cells. Root mean squares over joints and edges. Shape "
        "matching: a worm of 30 cells with a wave of curvature, at three node spacings, "
        "against the curve itself.",
        (
            Check(shapes.check_circle),
            Check(shapes.check_branches, FLOAT64),
            Check(partial(shapes.check_branches, dtype="float32")),
            Check(shapes.check_matching),
        ),
    ),
    Section(
        "Repulsion",
        "Two parallel chains of 20 nodes, free of force and torque each for itself; the "
        "mean of a body's steric displacement moves it past the fluid.",
        (Check(bodies.check_repulsion),),
    ),
    Section(
        "Gradients",
        "Two chains of 16 nodes two cells apart, by the amplitudes of their joints and by"
        " viscosity, in float64 with the limits off. With limits that act the outcome has"
        " kinks, so gradients only have to be finite.",
        (Check(gradients.check, "The kernel does not run these: it has no derivatives."),),
    ),
    Section(
        "The five known swimmers",
        "The Microcosmos paper's sweep, 1,200 steps a stroke, the third stroke of each: with "
        "actuators of one strength for all (ours), of unlimited strength (strong), "
        "and in the paper's literal form, which is not force-free. Strong actuators do not "
        "slow towards ν = 2: in Stokes flow a prescribed stroke leads as far at any "
        "viscosity. In the literal form bodies push themselves, by up to 170 in lattice "
        "units, so nothing is asked of it; docs/reproduction.md says what it shows.",
        (Check(sweep.check),),
    ),
    Section(
        "Random controllers",
        "32 nodes asked for angles of ± 1 rad and lengths of ± 30 %, drawn anew every 20 "
        "steps, with the limits of evaluations. The count is of seeds after which "
        "every number is finite and no fluid faster than sound.",
        (Check(bodies.check_stability),),
    ),
)
