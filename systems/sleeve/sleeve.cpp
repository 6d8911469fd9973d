#include "systems/sleeve/sleeve.hpp"

#include "engine/world.hpp"
#include "systems/sleeve/latex.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace bris {

namespace {

/// Where a node is held.
enum class Clamp { none, bottom, top };

class Clamps {
public:
    Clamps(const Sleeve& sleeve, std::size_t nodes) : columns_(sleeve.columns), nodes_(nodes) {}
    Clamp of(std::size_t node) const {
        return node < columns_             ? Clamp::bottom
               : node + columns_ >= nodes_ ? Clamp::top
                                           : Clamp::none;
    }

private:
    std::size_t columns_, nodes_;
};

/// Half the contacts' stiffness counts once more because grains move too, half the bounds of latex
/// and pressure do: a node of stiffness k has the mass k (dt / safety)^2, as scaled bodies have.
constexpr double safety = 0.9;

double mass_of(double stiffness, double latex, double dt) {
    return std::max(stiffness * (dt / safety) * (dt / safety), latex);
}

/// The forces of lane_count triangles on their corners.
struct OnCorners {
    TriangleForces latex;
    Vec3Lanes pressure; ///< N, on each corner
    Lane hold;          ///< N/m, of the pressure
    Lane volume;        ///< m3, between the triangle and the axis
};

OnCorners forces_of(const Sleeve& sleeve, const TriangleLanes& at, const RestLanes& rest) {
    const Vec3Lanes e = at[1] - at[0], f = at[2] - at[0], g = f - e, twice_area = cross(e, f),
                    sum = at[0] + at[1] + at[2];
    const Lane edges = sqrt(dot(e, e)) + sqrt(dot(f, f)) + sqrt(dot(g, g));
    return {stretch({sleeve.thickness, sleeve.young_modulus, sleeve.wrinkles}, rest, at),
            (sleeve.pressure / 6) * twice_area, (std::abs(sleeve.pressure) / 3) * edges,
            // the divergence of (x, y, 0) / 2 is 1, and the platens do not count
            (-1.0 / 12) * (sum.x * twice_area.x + sum.y * twice_area.y)};
}

Vec3 lane_of(const Vec3Lanes& v, int k) { return {v.x[k], v.y[k], v.z[k]}; }

/// The forces of the grains, to which others are added, and the stiffness of their contacts.
void begin_with_grains(NodeForces nodes, const SleeveSums& sums, const ForceGrid& grid,
                       double contact_stiffness) {
    for (std::size_t n = 0; n < nodes.size(); ++n) {
        const auto& sum = sums.of[n];
        Vec3& push = nodes.column<NodePush>()[n];
        for (int axis = 0; axis < 3; ++axis)
            push[axis] = grid.force * static_cast<double>(sum[static_cast<std::size_t>(axis)]);
        nodes.column<NodeForce>()[n] = push;
        nodes.column<NodePressure>()[n].setZero();
        nodes.column<NodeHold>()[n] =
            contact_stiffness * ElementSums::hold_unit * static_cast<double>(sum[3]);
    }
}

/// Adds what latex and pressure exert on the nodes, triangle after triangle; notes volume and
/// energy. Returns a stretch that the latex does not bear, or that is not a number; 0: none.
double add_triangles(NodeForces nodes, SleeveTriangles triangles, Sleeve& sleeve) {
    Vec3* force = nodes.column<NodeForce>();
    Vec3* pressure = nodes.column<NodePressure>();
    double* hold = nodes.column<NodeHold>();
    const auto* rest = reinterpret_cast<const double*>(triangles.column<RestShape>());
    const PlacedTriangle* at = triangles.column<TriangleAt>();
    sleeve.volume = sleeve.energy = 0;
    double torn = 0;
    for_lane_rows(0, static_cast<Row>(triangles.size()), [&](LaneRows rows) {
        const auto shape =
            read_rows<3>(rest, rows, [](const double* r) { return load_triples(r); });
        const auto within = [&](int q) {
            return rows.first + static_cast<Row>(std::min(q, rows.count - 1));
        };
        const OnCorners on = forces_of(
            sleeve, triangle_lanes([&](int q) -> const PlacedTriangle& { return at[within(q)]; }),
            {shape[0], shape[1], shape[2]});
        for (int q = 0; q < rows.count; ++q) {
            const auto& node = triangles.column<Corners>()[within(q)].node;
            const Vec3 of_pressure = lane_of(on.pressure, q);
            for (std::size_t k = 0; k < 3; ++k) {
                force[node[k]] += lane_of(on.latex.force[k], q) + of_pressure;
                pressure[node[k]] += of_pressure;
                hold[node[k]] += 0.5 * (on.latex.stiffness[k][q] + on.hold[q]);
            }
            sleeve.energy += on.latex.energy[q];
            sleeve.volume += on.volume[q];
            if (!(on.latex.stretch[q] <= sleeve.largest_stretch)) torn = on.latex.stretch[q];
        }
    });
    return torn;
}

} // namespace

void sum_sleeve(Rows<NearMembrane, const NearPair, const TreadOf> near,
                const NearIndex<MembranePairs>& index, Rows<Triangles, const Corners> triangles,
                Rows<Nodes, const NodeId> nodes, const ForceGrid& grid, const Overload& overload,
                SleeveSums& sums) {
    sums.of.assign(nodes.size(), {});
    if (overload.body != nobody) return;
    const double per_force = 1 / grid.force;
    index.for_touching([&](Row k) {
        const Tread& tread = near.column<TreadOf>()[k];
        const TriangleNodes& corners =
            triangles.column<Corners>()[near.column<NearPair>()[k].other];
        for (std::size_t i = 0; i < 3; ++i) {
            const double share = tread.share[static_cast<int>(i)];
            auto& sum = sums.of[corners.node[i]];
            for (std::size_t axis = 0; axis < 3; ++axis)
                sum[axis] += std::llrint(per_force * (share * tread.force[static_cast<int>(axis)]));
            sum[3] += std::llrint(share / ElementSums::hold_unit);
        }
    });
}

void pull_sleeve(NodeForces nodes, SleeveTriangles triangles,
                 Rows<Planes, const PlanePosition> planes, const SleeveSums& sums,
                 const ForceGrid& grid, Membrane& membrane, Sleeve& sleeve, Platen& platen,
                 Health& health) {
    sleeve.pressure = membrane.aim.next(membrane.target_pressure);
    begin_with_grains(nodes, sums, grid, membrane.contact_stiffness);
    if (const double torn = add_triangles(nodes, triangles, sleeve); torn != 0 && !health.bad) {
        health.bad = true;
        health.what = fmt::format("sleeve: expected triangles that are stretched up to {:g} times, "
                                  "found {:g}: the latex tears; try a larger thickness",
                                  sleeve.largest_stretch, torn);
    }
    const Vec3* force = nodes.column<NodeForce>();
    const Clamps clamps(sleeve, nodes.size());
    double off = 0, pressed = 0;
    platen.pull = 0;
    for (std::size_t n = 0; n < nodes.size(); ++n) {
        if (clamps.of(n) == Clamp::top) platen.pull -= force[n].z();
        if (clamps.of(n) != Clamp::none) continue;
        off += force[n].norm();
        pressed += nodes.column<NodePressure>()[n].norm();
    }
    sleeve.unbalanced = off / pressed;
    platen.area = sleeve.volume / planes.column<PlanePosition>()[platen.plane].point.z();
}

void accumulate_sleeve_work(Rows<Bodies, BoundaryWork> bodies,
                            Rows<Nodes, const NodePush, const NodeVelocity> nodes,
                            const Membrane& membrane, const Clock& clock) {
    double power = 0;
    for (std::size_t n = 0; n < nodes.size(); ++n)
        power -= nodes.column<NodePush>()[n].dot(nodes.column<NodeVelocity>()[n]);
    bodies.column<BoundaryWork>()[membrane.body_row] += 0.5 * clock.dt * power;
}

void move_sleeve(Rows<Nodes, const NodePush, const NodeForce, const NodePressure, const NodeHold,
                      const NodeLatex, NodePosition, NodeVelocity, NodeStiffness>
                     nodes,
                 const Membrane& membrane, const Platen& platen, const Clock& clock,
                 Sleeve& sleeve) {
    const Vec3* force = nodes.column<NodeForce>();
    const Vec3* pressure = nodes.column<NodePressure>();
    Vec3* velocity = nodes.column<NodeVelocity>();
    double* stiffness = nodes.column<NodeStiffness>();
    const Clamps clamps(sleeve, nodes.size());
    const double dt = clock.dt, fastest = membrane.largest_step / dt;
    double of_pressure = 0, of_clamps = 0, of_damping = 0;
    for (std::size_t n = 0; n < nodes.size(); ++n) {
        const Vec3 before = velocity[n];
        if (const Clamp clamp = clamps.of(n); clamp != Clamp::none || !membrane.active) {
            if (clamp == Clamp::bottom) velocity[n].setZero();
            if (clamp == Clamp::top) velocity[n] = Vec3(0, 0, -platen.speed);
            const Vec3 mean = 0.5 * (before + velocity[n]);
            of_clamps -= force[n].dot(mean);
            of_pressure += pressure[n].dot(mean);
            nodes.column<NodePosition>()[n] += dt * velocity[n];
            continue;
        }
        const double latex = nodes.column<NodeLatex>()[n];
        // a node that touches nothing is as heavy as with one contact, which may come at any time
        const double touching = nodes.column<NodeHold>()[n];
        const double old_mass = mass_of(stiffness[n], latex, dt);
        stiffness[n] = std::max({stiffness[n], touching, membrane.contact_stiffness});
        const double mass = mass_of(stiffness[n], latex, dt);
        const Vec3 v = (old_mass / mass) * before; // momentum is conserved
        const Vec3 kick = (dt / mass) * force[n];
        for (int axis = 0; axis < 3; ++axis) {
            const double power = force[n][axis] * (v[axis] + 0.5 * kick[axis]),
                         driven = power > 0   ? 1 - membrane.damping
                                  : power < 0 ? 1 + membrane.damping
                                              : 1;
            velocity[n][axis] = std::clamp(v[axis] + driven * kick[axis], -fastest, fastest);
        }
        // what the leapfrog does with the mean of both velocities
        const Vec3 mean = 0.5 * (v + velocity[n]), taken = force[n] - mass / dt * (velocity[n] - v);
        of_damping +=
            taken.dot(mean) + 0.5 / dt * (old_mass * before.squaredNorm() - mass * v.squaredNorm());
        of_pressure += pressure[n].dot(mean);
        nodes.column<NodePosition>()[n] += dt * velocity[n];
    }
    sleeve.pressure_work += dt * of_pressure;
    sleeve.clamp_work += dt * of_clamps;
    sleeve.damping_work += dt * of_damping;
}

void update_triangles(Rows<Triangles, const Corners, TriangleAt> triangles,
                      Rows<Nodes, const NodePosition> nodes) {
    const Vec3* position = nodes.column<NodePosition>();
    for (std::size_t t = 0; t < triangles.size(); ++t) {
        triangles.column<TriangleAt>()[t] = placed(
            triangles.column<Corners>()[t], [&](EntityId n) -> const Vec3& { return position[n]; });
    }
}

double kinetic_energy_of_sleeve(const World& world) {
    const auto& sleeve = world.resource<Sleeve>();
    const auto velocity = world.column<Nodes, NodeVelocity>();
    const auto stiffness = world.column<Nodes, NodeStiffness>();
    const auto latex = world.column<Nodes, NodeLatex>();
    const Clamps clamps(sleeve, velocity.size());
    const double dt = world.resource<Clock>().dt;
    double energy = 0;
    for (std::size_t n = 0; n < velocity.size(); ++n)
        if (clamps.of(n) == Clamp::none)
            energy += 0.5 * velocity[n].squaredNorm() * mass_of(stiffness[n], latex[n], dt);
    return energy;
}

} // namespace bris
