#pragma once

#include "scenarios/collision/impact.hpp"
#include "scenarios/specimens/small_scene.hpp"

namespace bris::detail {

/// A material with the elastic constants and density of a metal or plastic, as listed by Chung and
/// Ooi (2011). Moduli in Pa, density in kg/m3.
inline Material elastic(const char* name, double young, double poisson, double density,
                        double restitution = 1, double friction = 0) {
    Material m;
    m.name = name;
    m.young_modulus = young;
    m.poisson_ratio = poisson;
    m.density = density;
    m.restitution = restitution;
    m.friction = friction;
    return m;
}

/// An impact of a sphere on a rigid wall. The pair has the sphere's own restitution and friction.
inline Impact on_wall(const Material& material, double radius, double speed, LawName law) {
    Impact s;
    s.radius = radius;
    s.material = material;
    s.partner_material = rigid_material(material.friction);
    s.partner_material.restitution = material.restitution;
    s.law = law;
    s.speed = speed;
    return s;
}

inline constexpr double degree = pi / 180;

} // namespace bris::detail
