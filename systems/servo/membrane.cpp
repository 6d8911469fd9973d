#include "systems/servo/membrane.hpp"

#include "components/membrane_surface.hpp"

#include <algorithm>

namespace bris {

namespace {

// Relative to ring height times radius: with a smaller area the platen has passed the ring.
constexpr double least_area = 1e-3;

double area_at(const MembraneSurface& s, int ring, double share) {
    double area = 0;
    for (int k = 0; k < s.sectors; ++k)
        area += 0.5 * s.radius_between(ring, share, k) * s.exposed_width(ring, share, k);
    return area;
}

/// The part of the strip between the middles of two rings that lies between z = 0 and `top`, in
/// ring heights above the lower middle. The end strips reach down to 0 and up to any top.
struct Part {
    double from, to;
    Part(const MembraneSurface& s, int ring, double top) {
        const double above = ring + 1 < s.rings ? std::min(top, s.middle(ring + 1)) : top;
        from = (std::max(0.0, s.middle(ring)) - s.middle(ring)) / s.ring_height;
        to = std::max(from, (above - s.middle(ring)) / s.ring_height);
    }
};

} // namespace

double ring_area(const Membrane& membrane, const double* radius, std::size_t ring) {
    return area_at({membrane, radius}, static_cast<int>(ring), 0);
}

void compute_areas(const Membrane& membrane, const double* radius, double top, double* area) {
    const MembraneSurface s(membrane, radius);
    std::fill_n(area, s.rings * s.sectors, 0.0);
    for (int ring = -1; ring < s.rings; ++ring) {
        const Part p(s, ring, top);
        const double one = p.to - p.from, t = (p.to * p.to - p.from * p.from) / 2,
                     tt = (p.to * p.to * p.to - p.from * p.from * p.from) / 3;
        // widths and shares are linear in height
        for (int sector = 0; sector < s.sectors; ++sector) {
            const double width = s.exposed_width(ring, 0, sector),
                         wider = s.exposed_width(ring, 1, sector) - width;
            const double upper = s.ring_height * (width * t + wider * tt);
            area[s.element(ring + 1, sector)] += upper;
            area[s.element(ring, sector)] += s.ring_height * (width * one + wider * t) - upper;
        }
    }
}

double membrane_volume(const Membrane& membrane, const double* radius, double top) {
    const MembraneSurface s(membrane, radius);
    double volume = 0;
    for (int ring = -1; ring < s.rings; ++ring) {
        const Part p(s, ring, top);
        // the area is quadratic in height, for which Simpson's rule is exact
        volume += (p.to - p.from) * s.ring_height / 6 *
                  (area_at(s, ring, p.from) + 4 * area_at(s, ring, 0.5 * (p.from + p.to)) +
                   area_at(s, ring, p.to));
    }
    return volume;
}

double ServoMotion::next(double speed, double force, double touching) {
    constexpr double safety = 0.9; // mass = stiffness * (dt / safety)^2, as for scaled bodies
    const double lightest = (dt / safety) * (dt / safety);
    const auto heavier = [&] { return std::max(1.0, least_mass / (stiffness * lightest)); };
    if (touching > stiffness) { // momentum is conserved
        const double before = heavier();
        speed *= stiffness / touching;
        stiffness = touching;
        speed *= before / heavier();
    }
    // the damping needs the speed at the time of the force, half a step later
    const double kick = safety * safety * force / stiffness / heavier(),
                 now = speed * dt + 0.5 * kick;
    const double driven = force * now > 0 ? 1 - damping : force * now < 0 ? 1 + damping : 1;
    return std::clamp(speed * dt + driven * kick, -largest_step, largest_step) / dt;
}

void sum_membrane(const ElementSums& rows, const Overload& overload, MembraneSums& sums) {
    sums.of.assign(rows.elements, {});
    if (overload.body != nobody) return;
    for (std::size_t k = 0; k < rows.rows.size(); ++k) {
        auto& [push, hold] = sums.of[k % rows.elements];
        push += rows.rows[k].push;
        hold += rows.rows[k].hold;
    }
}

void push_membrane(Rows<Elements, ElementPush, ElementHold> elements, const MembraneSums& sums,
                   const ForceGrid& grid) {
    double* push = elements.column<ElementPush>();
    double* hold = elements.column<ElementHold>();
    for (std::size_t e = 0; e < elements.size(); ++e) {
        push[e] = grid.force * static_cast<double>(sums.of[e][0]);
        hold[e] = ElementSums::hold_unit * static_cast<double>(sums.of[e][1]);
    }
}

void accumulate_membrane_work(Rows<Bodies, BoundaryWork> bodies,
                              Rows<Elements, const ElementPush, const ElementSpeed> elements,
                              const Membrane& membrane, const Clock& clock) {
    const double* push = elements.column<ElementPush>();
    const double* speed = elements.column<ElementSpeed>();
    double power = 0;
    for (std::size_t e = 0; e < elements.size(); ++e) power -= push[e] * speed[e];
    bodies.column<BoundaryWork>()[membrane.body_row] += 0.5 * clock.dt * power;
}

void servo_membrane(
    Rows<Elements, ElementRadius, ElementSpeed, ElementArea, const ElementPush, const ElementHold>
        elements,
    Rows<Planes, const PlanePosition> planes, Membrane& membrane, Platen& platen,
    const Clock& clock, Health& health) {
    double* radius = elements.column<ElementRadius>();
    double* speed = elements.column<ElementSpeed>();
    double* area = elements.column<ElementArea>();
    const double* push = elements.column<ElementPush>();
    const double* hold = elements.column<ElementHold>();
    compute_areas(membrane, radius, planes.column<PlanePosition>()[platen.plane].point.z(), area);
    const double aim = membrane.aim.next(membrane.target_pressure);
    const std::size_t group = membrane.per_element ? 1 : membrane.sectors;
    for (std::size_t g = 0; g < elements.size() / group; ++g) {
        double force = 0, on = 0, stiffness = 0;
        for (std::size_t e = g * group; e < (g + 1) * group; ++e) {
            if (area[e] < 0 && !health.bad) {
                health.bad = true;
                health.what = "membrane element " + std::to_string(e) +
                              " is hidden by its neighbours: expected an exposed area of at least "
                              "0 m2, found " +
                              std::to_string(area[e]) + " m2; try the servo per ring";
            }
            force += push[e];
            on += area[e];
            stiffness += hold[e] * membrane.contact_stiffness;
        }
        const bool passed = on < least_area * membrane.ring_height * radius[g * group] &&
                            g * group >= membrane.sectors;
        membrane.pressure[g] = passed ? aim : force / on;
        // the stiffness is at least that of one contact per element
        ServoMotion servo{membrane.stiffness[g], membrane.damping, membrane.largest_step, clock.dt};
        const double next = servo.next(
            speed[g * group], force - aim * on,
            std::max(stiffness, static_cast<double>(group) * membrane.contact_stiffness));
        for (std::size_t e = g * group; e < (g + 1) * group; ++e) {
            if (membrane.active) speed[e] = passed ? speed[e - membrane.sectors] : next;
            radius[e] += speed[e] * clock.dt;
            if (radius[e] > membrane.largest_step || health.bad)
                continue; // a radius that is not a number does not continue
            health.bad = true;
            health.what =
                "membrane element " + std::to_string(e) +
                " has reached the axis: expected grains that carry the target pressure of " +
                std::to_string(membrane.target_pressure) + " Pa, found none";
        }
    }
    platen.area = 0;
    for (std::size_t ring = 0; ring < membrane.rings; ++ring)
        platen.area += ring_area(membrane, radius, ring) / membrane.rings;
}

} // namespace bris
