#include "scenarios/python/written_columns.hpp"

#include "components/body.hpp"
#include "components/kinds.hpp"
#include "components/membrane.hpp"
#include "engine/errors.hpp"
#include "systems/broadphase/lists.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>
#include <span>

namespace bris {

namespace {

constexpr std::array<const char*, 5> writable{Position::name, Orientation::name, Velocity::name,
                                              DriveVelocity::name, AngularVelocity::name};
constexpr double unit_norm = 1e-6; // largest difference from 1 of the norm of an orientation

void expect(bool is_met, const Table& bodies, Row row, const Column& column,
            const std::string& what) {
    if (is_met) return;
    const auto* value = reinterpret_cast<const double*>(column.bytes()) +
                        row * (column.type().value_size / sizeof(double));
    throw InputError(
        fmt::format("view: body {}: {}: expected {}, found ({:g})", bodies.column<BodyId>()[row],
                    column.type().name, what,
                    fmt::join(value, value + column.type().value_size / sizeof(double), ", ")));
}

std::span<const double> numbers(const Column& column, Row row) {
    const std::size_t count = column.type().value_size / sizeof(double);
    return {reinterpret_cast<const double*>(column.bytes()) + row * count, count};
}

bool is_membrane(const World& world, Row row) {
    return world.has_resource<Membrane>() &&
           world.column<Bodies, BodyId>()[row] == world.resource<Membrane>().body;
}

void check_row(const World& world, const Column& column, Row row) {
    const Table& bodies = world.table<Bodies>();
    const std::string& name = column.type().name;
    const auto motion = static_cast<Motion>(bodies.column<MotionOf>()[row]);
    const auto numbers_of_row = numbers(column, row);
    expect(std::ranges::all_of(numbers_of_row, [](double x) { return std::isfinite(x); }), bodies,
           row, column, fmt::format("finite numbers ({})", column.type().unit));
    expect(motion != Motion::servo && !is_membrane(world, row), bodies, row, column,
           "no other value for a body that a servo moves");
    if (name == Velocity::name)
        expect(motion == Motion::free, bodies, row, column,
               "no other value for a body that is not free (see drive)");
    if (name == DriveVelocity::name)
        expect(motion == Motion::prescribed, bodies, row, column,
               "no other value for a body whose motion is not prescribed");
    if (name != Orientation::name) return;
    expect(motion == Motion::free, bodies, row, column,
           "no other value for a body that is not free");
    const Eigen::Map<const Eigen::Vector4d> quaternion(numbers_of_row.data());
    expect(std::abs(quaternion.norm() - 1) <= unit_norm, bodies, row, column,
           "a quaternion of norm 1");
}

/// Angular momentum and velocity over the step of the body in a row follow from its angular
/// velocity and orientation.
void renew_rotation(Table& bodies, Row row) {
    const Vec3& omega = bodies.column<AngularVelocity>()[row];
    bodies.column<StepAngularVelocity>()[row] = omega;
    Vec3& momentum = bodies.column<AngularMomentum>()[row];
    if (bodies.has<SphereInertia>()) {
        momentum = bodies.column<SphereInertia>()[row] * omega;
        return;
    }
    const Quat& q = bodies.column<Orientation>()[row];
    const Vec3 local = q.conjugate() * omega;
    momentum = q * Vec3(local.cwiseProduct(bodies.column<InertialInertia>()[row]));
}

template <class Visit>
void for_rows_written(const Column& column, const std::vector<std::byte>& before, Visit&& visit) {
    const std::size_t size = column.type().value_size;
    for (Row row = 0; row < column.size(); ++row)
        if (std::memcmp(column.bytes() + row * size, before.data() + row * size, size) != 0)
            visit(row);
}

} // namespace

void WrittenColumns::hand_out(const std::string& table, Column& column) {
    require(table == Bodies::name &&
                std::ranges::find(writable, column.type().name) != writable.end(),
            fmt::format("view: expected one of the columns {} of bodies to write to, found {}.{}",
                        fmt::join(writable, ", "), table, column.type().name));
    if (std::ranges::find(handed_out_, &column, &HandedOut::column) != handed_out_.end()) return;
    const std::byte* bytes = column.bytes();
    handed_out_.push_back({&column, {bytes, bytes + column.size() * column.type().value_size}});
}

void WrittenColumns::take_up(World& world, bool still_shown) {
    bool moved = false, written = false;
    for (const auto& [column, before] : handed_out_)
        for_rows_written(*column, before, [&](Row row) { check_row(world, *column, row); });
    Table& bodies = world.table<Bodies>();
    for (auto& [column, before] : handed_out_) {
        const std::string& name = column->type().name;
        const bool turns = name == AngularVelocity::name || name == Orientation::name;
        bool changed = false;
        for_rows_written(*column, before, [&](Row row) {
            if (turns) renew_rotation(bodies, row);
            changed = true;
        });
        written = written || changed;
        moved = moved || (changed && (name == Position::name || name == Orientation::name));
        if (still_shown) std::memcpy(before.data(), column->bytes(), before.size());
    }
    if (moved)
        invalidate_lists(world);
    else if (written)
        show_velocities(world);
    if (!still_shown) handed_out_.clear();
}

} // namespace bris
