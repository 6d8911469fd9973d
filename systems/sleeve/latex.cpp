#include "systems/sleeve/latex.hpp"

namespace bris {

namespace {

/// Components of symmetric tensors in the plane of the sheet at rest.
struct Plane {
    Lane xx, xy, yy;
};

Plane select(LaneMask where, const Plane& a, const Plane& b) {
    return {where ? a.xx : b.xx, where ? a.xy : b.xy, where ? a.yy : b.yy};
}

/// Right Cauchy-Green tensor, its determinant and eigenvalues: the squares of the stretches.
struct Strain {
    Plane c;
    Lane determinant, larger, smaller;
};

Strain strain_of(const Vec3Lanes& one, const Vec3Lanes& two) {
    Strain s;
    s.c = {dot(one, one), dot(one, two), dot(two, two)};
    const Lane mean = 0.5 * (s.c.xx + s.c.yy), half = 0.5 * (s.c.xx - s.c.yy);
    s.determinant = s.c.xx * s.c.yy - s.c.xy * s.c.xy;
    s.larger = mean + sqrt(half * half + s.c.xy * s.c.xy);
    s.smaller = s.determinant / s.larger;
    return s;
}

/// Second Piola-Kirchhoff stress over the shear modulus, energy per volume over the shear modulus,
/// and a bound of the second derivatives of that energy by the principal stretches.
struct Response {
    Plane stress;
    Lane energy, stiffness;
};

Response taut(const Strain& s) {
    const Lane inverse = 1.0 / s.determinant, quartic = inverse * inverse;
    // with stretches a > b: 1 + 3 / (a^2 b^4), 2 / (a b)^3, and 1 of the stress itself
    const Lane along = 3.0 * inverse / s.smaller, across = 2.0 * inverse / sqrt(s.determinant);
    return {{1.0 - s.c.yy * quartic, s.c.xy * quartic, 1.0 - s.c.xx * quartic},
            0.5 * (s.larger + s.smaller + inverse - 3.0),
            2.0 + along + across};
}

constexpr double stiffness_at_rest = 7;

/// Simple tension along the direction of the larger stretch.
Response in_tension(const Strain& s) {
    const Lane a = sqrt(s.larger), along = (1.0 - 1.0 / (a * s.larger)) / (s.larger - s.smaller);
    return {{along * (s.c.xx - s.smaller), along * s.c.xy, along * (s.c.yy - s.smaller)},
            0.5 * (s.larger + 2.0 / a - 3.0),
            lanes(stiffness_at_rest)};
}

Response response_of(const Strain& s, bool wrinkles) {
    Response r = taut(s);
    if (!wrinkles) return r;
    const LaneMask folds = s.smaller * s.smaller * s.larger < 1.0;
    if (bits(folds) == 0) return r;
    const Response tension = in_tension(s);
    const LaneMask slack = folds & (s.larger <= 1.0);
    const Lane none{};
    r.stress = select(slack, {none, none, none}, select(folds, tension.stress, r.stress));
    r.energy = slack ? none : (folds ? tension.energy : r.energy);
    r.stiffness = folds ? tension.stiffness : r.stiffness;
    return r;
}

} // namespace

TriangleForces stretch(const Latex& latex, const RestLanes& rest, const TriangleLanes& x) {
    const Lane slant = rest.back / rest.along, left = 1.0 / rest.along, g2 = 1.0 / rest.high,
               down = slant * g2, up = g2 - down;
    // columns of the deformation gradient
    const Vec3Lanes edge = x[1] - x[0], one = left * edge,
                    two = g2 * ((x[2] - x[0]) - slant * edge);
    const Strain strain = strain_of(one, two);
    const Response r = response_of(strain, latex.wrinkles);
    // first Piola-Kirchhoff stress times the gradients of the corners' shares
    const Vec3Lanes p = r.stress.xx * one + r.stress.xy * two,
                    q = r.stress.xy * one + r.stress.yy * two;
    const Lane scale = latex.young_modulus / 3 * (0.5 * latex.thickness) * rest.along * rest.high;
    TriangleForces f;
    f.force[1] = scale * (down * q - left * p);
    f.force[2] = (-scale * g2) * q;
    f.force[0] = -1.0 * (f.force[1] + f.force[2]);
    const Lane g1 = sqrt(left * left + down * down), g0 = sqrt(left * left + up * up),
               all = scale * r.stiffness * (g0 + g1 + g2);
    f.stiffness = {all * g0, all * g1, all * g2};
    f.energy = scale * r.energy;
    f.stretch = sqrt(strain.larger);
    return f;
}

} // namespace bris
