#pragma once

#include "engine/archive.hpp"
#include "engine/component.hpp"
#include "engine/entity.hpp"
#include "engine/math.hpp"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <tuple>
#include <vector>

namespace bris {

/// A factor as a function of time: mean + amplitude sin(2 pi frequency (t - start) + phase) for
/// t >= start, and its value at `start` before; or, where `times` is not empty, a table that is
/// interpolated linearly and constant beyond its ends.
struct LoadHistory {
    double mean = 1, amplitude = 0;
    double frequency = 0, phase = 0, start = 0;  ///< Hz, rad, s
    std::vector<double> times = {}, values = {}; ///< s, ascending

    double at(double time) const {
        if (times.empty())
            return mean +
                   amplitude * std::sin(2 * pi * frequency * std::max(0.0, time - start) + phase);
        const auto next = std::upper_bound(times.begin(), times.end(), time) - times.begin();
        if (next == 0) return values.front();
        const auto k = static_cast<std::size_t>(next);
        if (k == times.size()) return values.back();
        const double part = (time - times[k - 1]) / (times[k] - times[k - 1]);
        return values[k - 1] + part * (values[k] - values[k - 1]);
    }
};

/// A force and a couple on a body, both fixed in direction, times a history.
struct Load {
    Vec3 force = Vec3::Zero();  ///< N, world frame
    Vec3 couple = Vec3::Zero(); ///< N m, world frame
    Vec3 point = Vec3::Zero();  ///< m, where the force acts, in the axes of the body
    LoadHistory history = {};
};

/// A spring and a dashpot along an axis fixed in space, between a point of a body and the ground: a
/// patch of the subgrade, a rail pad, a guide or a stop.
struct SpringPatch {
    Vec3 point = Vec3::Zero();  ///< m, in the axes of the body
    Vec3 anchor = Vec3::Zero(); ///< m, where the point is while the spring is unloaded
    Vec3 axis = Vec3::UnitZ();  ///< unit vector
    double stiffness = 0;       ///< N/m
    double damping = 0;         ///< N s/m
    /// True: a support that pushes along the axis and never pulls.
    bool one_sided = false;

    /// m, along the axis, of the point when it is at `x`; negative: the spring is pressed.
    double displacement(const Vec3& x) const { return (x - anchor).dot(axis); }
    /// Force (N) along the axis on the body; `speed`: m/s, of the point along the axis.
    double force(double displaced, double speed) const {
        const double f = -(stiffness * displaced + damping * speed);
        if (!one_sided) return f;
        return displaced < 0 ? std::max(f, 0.0) : 0;
    }
    /// Elastic energy, J.
    double energy(double displaced) const {
        return one_sided && displaced >= 0 ? 0 : 0.5 * stiffness * displaced * displaced;
    }
};

/// 1 + index in Loads::of_body; 0: none.
struct LoadOf : State<std::uint32_t> {
    static constexpr auto name = "load", unit = "";
};
/// 1 + index in SpringPatches::of_body; 0: none.
struct PatchesOf : State<std::uint32_t> {
    static constexpr auto name = "patches", unit = "";
};

/// Force (N) and torque about Position (N m).
struct Wrench {
    Vec3 force = Vec3::Zero(), torque = Vec3::Zero();
};
/// Sum of the loads on a body in this step.
struct LoadForce : Derived<Wrench> {
    static constexpr auto name = "load_force", unit = "N, N m";
};
/// Sum of the forces of patches on a body in this step.
struct PatchForce : Derived<Wrench> {
    static constexpr auto name = "patch_force", unit = "N, N m";
};

/// Work that loads have done on the body. Exists only with an energy budget.
struct LoadWork : State<double> {
    static constexpr auto name = "load_work", unit = "J";
};
/// Energy dissipated by the dashpots of the body's patches.
struct PatchWork : State<double> {
    static constexpr auto name = "patch_work", unit = "J";
};

namespace detail {

/// Numbers that describe a list of things with a varying number each.
class NumberList {
public:
    void put(double number) { numbers_.push_back(number); }
    void put(const Vec3& v) {
        for (int k = 0; k < 3; ++k) put(v[k]);
    }
    void put(const std::vector<double>& list) {
        put(static_cast<double>(list.size()));
        for (const double number : list) put(number);
    }
    double next() { return numbers_.at(at_++); }
    Vec3 next_vector() {
        const double x = next(), y = next(), z = next();
        return {x, y, z};
    }
    std::size_t next_count() { return static_cast<std::size_t>(next()); }
    std::vector<double> next_list() {
        std::vector<double> list(next_count());
        for (double& number : list) number = next();
        return list;
    }
    void save(Archive& archive, const char* path) const {
        archive.put(path, std::span<const double>(numbers_));
    }
    void load(const Archive& archive, const char* path) { numbers_ = archive.get<double>(path); }

private:
    std::vector<double> numbers_;
    std::size_t at_ = 0;
};

} // namespace detail

/// The loads of a scene. Phases may change them between steps.
struct Loads {
    static constexpr auto name = "loads";
    static constexpr bool is_state = true;
    std::vector<std::vector<Load>> of_body; ///< by the number in LoadOf, minus 1

    void save(Archive& archive) const {
        detail::NumberList n;
        n.put(static_cast<double>(of_body.size()));
        for (const auto& list : of_body) {
            n.put(static_cast<double>(list.size()));
            for (const auto& [force, couple, point, h] : list) {
                n.put(force);
                n.put(couple);
                n.put(point);
                for (const double x : {h.mean, h.amplitude, h.frequency, h.phase, h.start})
                    n.put(x);
                n.put(h.times);
                n.put(h.values);
            }
        }
        n.save(archive, "loads");
    }
    void load(const Archive& archive) {
        detail::NumberList n;
        n.load(archive, "loads");
        of_body.assign(n.next_count(), {});
        for (auto& list : of_body) {
            list.resize(n.next_count());
            for (auto& [force, couple, point, h] : list) {
                force = n.next_vector();
                couple = n.next_vector();
                point = n.next_vector();
                for (double* x : {&h.mean, &h.amplitude, &h.frequency, &h.phase, &h.start})
                    *x = n.next();
                h.times = n.next_list();
                h.values = n.next_list();
            }
        }
    }
};

/// The springs and dashpots between bodies and the ground.
struct SpringPatches {
    static constexpr auto name = "spring_patches";
    static constexpr bool is_state = true;
    std::vector<std::vector<SpringPatch>> of_body; ///< by the number in PatchesOf, minus 1

    void save(Archive& archive) const {
        detail::NumberList n;
        n.put(static_cast<double>(of_body.size()));
        for (const auto& list : of_body) {
            n.put(static_cast<double>(list.size()));
            for (const SpringPatch& p : list) {
                for (const Vec3* v : {&p.point, &p.anchor, &p.axis}) n.put(*v);
                for (const double x : {p.stiffness, p.damping, p.one_sided ? 1.0 : 0.0}) n.put(x);
            }
        }
        n.save(archive, "spring_patches");
    }
    void load(const Archive& archive) {
        detail::NumberList n;
        n.load(archive, "spring_patches");
        of_body.assign(n.next_count(), {});
        for (auto& list : of_body) {
            list.resize(n.next_count());
            for (SpringPatch& p : list) {
                for (Vec3* v : {&p.point, &p.anchor, &p.axis}) *v = n.next_vector();
                for (double* x : {&p.stiffness, &p.damping}) *x = n.next();
                p.one_sided = n.next() != 0;
            }
        }
    }
};

} // namespace bris
