#include "tests/verification/crystal.hpp"

#include "components/settings.hpp"
#include "engine/errors.hpp"
#include "scenarios/specimens/small_scene.hpp"
#include "systems/broadphase/lists.hpp"

#include <cmath>
#include <limits>

namespace bris {

namespace {

constexpr double heavy = 1e30; // kg/m3, so heavy that no force moves it

double contact_force(const Crystal& s) {
    const double each =
        0.5 * static_cast<double>(neighbours(s.lattice).size()); // contacts per sphere
    return 3 * s.pressure * cell_volume(s.lattice) * s.spacing * s.spacing / each;
}

/// Overlap (m) at a contact force (N). The radius is half the spacing plus half the overlap.
double overlap_at(const Crystal& s, double force) {
    if (!is_hertz(s.law)) return force / (0.5 * s.material.normal_stiffness);
    const double modulus =
        0.5 * s.material.young_modulus / (1 - s.material.poisson_ratio * s.material.poisson_ratio);
    double overlap = 0;
    for (int k = 0; k < 60; ++k)
        overlap =
            std::pow(0.75 * force / (modulus * std::sqrt(0.25 * (s.spacing + overlap))), 2.0 / 3);
    return overlap;
}

struct Strained {
    Mat3 stress = Mat3::Zero(); // Pa, compression positive: change without rotation of contacts
    double pressure = 0, unbalanced = 0;
};

Strained strain(const Crystal& s, double overlap, const Mat3& tensor) {
    World world = make_world(Grains::spheres);
    Material heavy_material = s.material;
    heavy_material.density = heavy;
    const auto material = world.resource<Materials>().add(heavy_material);
    const double radius = 0.5 * (s.spacing + overlap), dt = 1;
    const EntityId middle = add_sphere(world, Vec3::Zero(), radius, material);
    constexpr int steps = 4;
    for (const Vec3& n : neighbours(s.lattice)) {
        const EntityId id = add_sphere(world, s.spacing * n, radius, material, Motion::prescribed);
        value_of<DriveVelocity>(world, id) = s.spacing / (steps * dt) * (tensor * n);
    }
    Simulation sim = begin(std::move(world), {.dt = dt, .law = s.law, .unlimited = true});
    Strained r;
    sim.advance();
    const auto before = touching_pairs<SpherePairs>(sim.world());
    std::vector<Vec3> branch; // branch vectors from the neighbours before the strain
    for (const TouchingPair& p : before)
        branch.push_back(-s.spacing * neighbours(s.lattice).at(p.names.partner - 1));
    sim.advance(steps);
    const auto after = touching_pairs<SpherePairs>(sim.world());
    const double volume = cell_volume(s.lattice) * std::pow(s.spacing, 3);
    const auto force = [](const TouchingPair& p) {
        return Vec3(p.force.fx, p.force.fy, p.force.fz);
    };
    for (std::size_t k = 0; k < before.size(); ++k) {
        const Vec3 n = branch[k].normalized(), m = (branch[k] + tensor * branch[k]).normalized();
        const Vec3 change =
            force(after[k]) - force(before[k]) - before[k].force.normal_force * (m - n);
        r.stress += 0.5 / volume * change * branch[k].transpose();
        r.pressure += 0.5 / (3 * volume) * force(before[k]).dot(branch[k]);
    }
    r.unbalanced = value_of<Force>(sim, middle).norm() / before.at(0).force.normal_force;
    return r;
}

} // namespace

std::vector<Vec3> neighbours(CrystalLattice lattice) {
    std::vector<Vec3> list;
    for (int x = -1; x <= 1; ++x)
        for (int y = -1; y <= 1; ++y)
            for (int z = -1; z <= 1; ++z) {
                const int squares = x * x + y * y + z * z;
                if (squares == (lattice == CrystalLattice::simple
                                    ? 1
                                    : (lattice == CrystalLattice::face_centred ? 2 : 3)))
                    list.push_back(Vec3(x, y, z).normalized());
            }
    return list;
}

double cell_volume(CrystalLattice lattice) {
    if (lattice == CrystalLattice::simple) return 1;
    return lattice == CrystalLattice::face_centred ? 1 / std::sqrt(2.0) : 4 / (3 * std::sqrt(3.0));
}

void check(const Crystal& s) {
    require(s.pressure > 0 && s.strain > 0, "crystal: expected a pressure and a strain above 0");
    require(s.strain < 0.1 * overlap_at(s, contact_force(s)) / s.spacing,
            "crystal: expected a strain below a tenth of overlap over spacing");
}

CrystalResult run_experiment(const Crystal& s) {
    check(s);
    CrystalResult r;
    r.contact_force = contact_force(s);
    r.overlap = overlap_at(s, r.contact_force);
    const auto modulus = [&](int strained_a, int strained_b, int i, int j) {
        Mat3 tensor = Mat3::Zero();
        tensor(strained_a, strained_b) = tensor(strained_b, strained_a) = s.strain;
        const Strained plus = strain(s, r.overlap, tensor), minus = strain(s, r.overlap, -tensor);
        r.pressure = plus.pressure;
        r.unbalanced = std::max({r.unbalanced, plus.unbalanced, minus.unbalanced});
        return -(plus.stress(i, j) - minus.stress(i, j)) / (2 * s.strain);
    };
    r.c11 = modulus(0, 0, 0, 0);
    r.c12 = modulus(0, 0, 1, 1);
    r.c44 = 0.5 * modulus(0, 1, 0, 1); // tensor shear strain is half the engineering shear strain
    r.bulk = (r.c11 + 2 * r.c12) / 3;
    return r;
}

std::vector<Neighbour> held(CrystalLattice lattice) {
    std::vector<Neighbour> list;
    for (const Vec3& n : neighbours(lattice)) list.push_back({n, 0, 0});
    return list;
}
std::vector<Neighbour> in_phase(CrystalLattice lattice) {
    std::vector<Neighbour> list;
    for (const Vec3& n : neighbours(lattice)) list.push_back({n, 1, 1});
    return list;
}
std::vector<Neighbour> zone_boundary(CrystalLattice lattice) {
    std::vector<Neighbour> list;
    for (const Vec3& n : neighbours(lattice)) {
        // points R and H: all neighbours in antiphase; X: those outside the plane x = const
        const double sign = lattice == CrystalLattice::face_centred && n.x() == 0 ? 1 : -1;
        list.push_back({n, sign, sign});
    }
    return list;
}
std::vector<Neighbour> one_held() { return {{Vec3(0, 0, -1), 0, 0}}; }
std::vector<Neighbour> free_pair() { return {{Vec3(0, 0, -1), -1, 1}}; }

namespace {

constexpr double spacing = 0.02, kn = 1e5;

/// Whether a disturbance grows by a factor of 1e4 at a step in units of sqrt(m/kn).
bool grows(const StabilityLimit& s, double step) {
    World world = make_world(Grains::spheres);
    const auto material =
        world.resource<Materials>().add(linear_material(kn, s.shear_ratio * kn, 1e6));
    const double radius = 0.5 * spacing * (1 + s.overlap);
    const EntityId middle = add_sphere(world, Vec3::Zero(), radius, material);
    const double mass = value_of<InertialMass>(world, middle),
                 disturbance = 1e-6 * s.overlap * spacing;
    Vec3 push = Vec3::Zero(); // N, of the neighbours at rest; gravity balances it
    for (const Neighbour& n : s.around) {
        add_sphere(world, spacing * n.direction, radius, material, Motion::fixed);
        push -= kn * s.overlap * spacing * n.direction;
    }
    world.add_resource<Gravity>({-push / mass});
    const double dt = step * std::sqrt(mass / kn);
    value_of<Velocity>(world, middle) = disturbance / dt * Vec3(0.5, 0.7, -0.6);
    set_angular_velocity(world, middle, disturbance / (radius * dt) * Vec3(-0.6, 0.5, 0.8));
    Simulation sim = begin(std::move(world), {.dt = dt, .law = LawName::linear, .unlimited = true});
    const auto copy = [&] { // moves the neighbours as the sphere moves
        World& w = sim.world();
        const Vec3 x = value_of<Position>(w, middle), v = value_of<Velocity>(w, middle);
        const Vec3 angular_velocity = value_of<AngularVelocity>(w, middle),
                   step_angular_velocity = value_of<StepAngularVelocity>(w, middle);
        EntityId id = middle;
        for (const Neighbour& n : s.around) {
            ++id;
            value_of<Position>(w, id) = spacing * n.direction + n.translation * x;
            value_of<Velocity>(w, id) = n.translation * v;
            value_of<AngularVelocity>(w, id) = n.angular_velocity * angular_velocity;
            value_of<StepAngularVelocity>(w, id) = n.angular_velocity * step_angular_velocity;
        }
        invalidate_lists(w);
        return x.norm() + radius * step_angular_velocity.norm() * dt;
    };
    copy();
    for (unsigned k = 0; k < s.steps; ++k) {
        sim.advance();
        if (!(copy() < 1e4 * disturbance)) return true;
    }
    return false;
}

} // namespace

double run_experiment(const StabilityLimit& s) {
    // sqrt(m/kn): the limit of a dozen stiff contacts, and twice the limit of one contact
    double low = 0.05, high = 4;
    if (grows(s, low))
        throw SimulationError("stability limit: expected at least 0.05 sqrt(m/kn), found less");
    if (!grows(s, high)) return std::numeric_limits<double>::infinity();
    while (high - low > 2e-4 * high) {
        const double middle = 0.5 * (low + high);
        (grows(s, middle) ? high : low) = middle;
    }
    return 0.5 * (low + high);
}

} // namespace bris
