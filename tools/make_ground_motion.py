"""Make a synthetic ground motion: Gaussian noise through the soil filter of Kanai and Tajimi, under an envelope.

Usage: make_ground_motion.py [--seed N] [--peak A] > FILE.csv. Rows of time [s] and acceleration [m/s2].

    x'' + 2 z w x' + w^2 x = -noise(t),   ground acceleration = -(2 z w x' + w^2 x)

with w = 15 rad/s and z = 0.6 (firm ground; Tajimi 1960), less what is slower than 0.25 Hz (Clough and Penzien 1975),
which would let the ground drift. The envelope rises with t^2 to 3 s, stays to 10 s, and falls as exp(-0.4 (t - 10)).
"""
import argparse
import math
import random

STEP, DURATION = 0.01, 20.0
GROUND = (15.0, 0.6)  # rad/s, damping ratio
HIGH_PASS = (2 * math.pi * 0.25, 0.6)


def envelope(t):
    if t < 3.0:
        return (t / 3.0) ** 2
    return 1.0 if t < 10.0 else math.exp(-0.4 * (t - 10.0))


def oscillator(load, omega, ratio):
    """Displacement and velocity of x'' + 2 ratio omega x' + omega^2 x = -load from rest, by the trapezoidal rule."""
    x = v = 0.0
    motion = [(x, v)]
    h = STEP
    scale = 1.0 + ratio * omega * h + 0.25 * (omega * h) ** 2
    for before, after in zip(load, load[1:]):
        force = -0.5 * (before + after)
        change = (force - 2.0 * ratio * omega * v - omega * omega * (x + 0.5 * h * v)) * h / scale
        x, v = x + h * (v + 0.5 * change), v + change
        motion.append((x, v))
    return motion


def ground_motion(seed, peak):
    source = random.Random(seed)
    times = [i * STEP for i in range(round(DURATION / STEP) + 1)]
    noise = [envelope(t) * source.gauss(0.0, 1.0) for t in times]
    omega, ratio = GROUND
    shaken = [-(2.0 * ratio * omega * v + omega * omega * x) for x, v in oscillator(noise, omega, ratio)]
    omega, ratio = HIGH_PASS
    filtered = [a - 2.0 * ratio * omega * v - omega * omega * x  # the acceleration of the oscillator
                for a, (x, v) in zip(shaken, oscillator([-a for a in shaken], omega, ratio))]
    largest = max(abs(a) for a in filtered)
    return [(t, peak * a / largest) for t, a in zip(times, filtered)]


def main():
    parser = argparse.ArgumentParser(description=__doc__.split("\n")[0])
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--peak", type=float, default=3.5, help="largest acceleration [m/s2]")
    options = parser.parse_args()
    print("time [s],acceleration [m/s2]")
    for t, a in ground_motion(options.seed, options.peak):
        print(f"{t:.2f},{a:.6f}")


if __name__ == "__main__":
    main()
