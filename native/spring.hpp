// The law of a cable's tension, as TensionLaw in mechanics/tension_law.py explains it.
#pragma once

struct Spring {
    double energy, tension, slope;
};

inline Spring spring(double k, double eps, double elongation) {
    if (elongation <= 0.0) return {0.0, 0.0, 0.0};
    if (elongation <= 2.0 * eps)
        return {k * (elongation * (elongation * elongation)) / (12.0 * eps), k * elongation * elongation / (4.0 * eps),
                k * elongation / (2.0 * eps)};
    double beyond = elongation - eps;
    return {0.5 * k * (beyond * beyond) + k * eps * eps / 6.0, k * beyond, k};
}
