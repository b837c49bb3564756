"""Energy of a double pendulum by the number of substeps: python compare.py [FILE.png]"""

import sys

import matplotlib

matplotlib.use("Agg")
import matplotlib.pyplot as plt
import numpy as np
from backstop import Shape, World

DT, SECONDS = 1 / 60, 10


def pendulum(substeps: int) -> tuple[np.ndarray, np.ndarray]:
    """Times [s], and the change of the energy by the greatest kinetic energy that it could have."""
    world = World(substeps=substeps)
    post = world.add_body("static")
    rod = Shape.box((0.5, 0.05, 0.05))
    first = world.add_body(position=(0.5, 0, 0), shapes=[rod])
    second = world.add_body(position=(1.5, 0, 0), shapes=[rod])
    world.add_hinge((post, first), (0, 0, 0), (0, 0, 1))
    world.add_hinge((first, second), (1, 0, 0), (0, 0, 1))
    # Both rods start level: at the lowest, their centres are 0.5 m and 1.5 m below.
    most = (0.5 * world.mass(first) + 1.5 * world.mass(second)) * 9.81
    start = world.energy()
    times = np.arange(1, round(SECONDS / DT) + 1) * DT
    energy = np.empty(len(times))
    for index in range(len(times)):
        world.step(DT)
        energy[index] = world.energy()
    return times, (energy - start) / most


def main(file: str) -> None:
    figure, axes = plt.subplots(figsize=(8, 4.5), layout="constrained")
    worst = {}
    for substeps in (1, 2, 4, 8, 16):
        times, change = pendulum(substeps)
        worst[substeps] = np.abs(change).max()
        axes.semilogy(times, 100 * np.maximum.accumulate(np.abs(change)), label=f"{substeps}")
    axes.set(
        title="A double pendulum, steps of 1/60 s",
        xlabel="time [s]",
        ylabel="greatest change of energy until then [%]",
        ylim=(1e-4, 10),
    )
    axes.grid(alpha=0.3)
    axes.legend(title="substeps")
    figure.savefig(file, dpi=120)
    for substeps, change in worst.items():
        print(f"{substeps:2} substeps: {100 * change:.2g} % at most")
    assert worst[16] < worst[4] < worst[1], worst


if __name__ == "__main__":
    main(sys.argv[1] if len(sys.argv) > 1 else "energy.png")
