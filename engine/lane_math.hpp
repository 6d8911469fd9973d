#pragma once

#include "engine/entity.hpp"
#include "engine/lanes.hpp"
#include "engine/math.hpp"

#include <algorithm>
#include <cstring>

namespace bris {

// Vectors, quaternions and rotations of lane_count bodies at a time, and access to their columns.
// Every lane performs the same operations, so the bits of a body do not depend on its lane.

struct Vec3Lanes {
    Lane x, y, z;
};
struct QuatLanes {
    Lane x, y, z, w;
};
/// The three axes of a body in the world frame: columns of its rotation matrix.
struct AxesLanes {
    Vec3Lanes x, y, z;
};

inline Vec3Lanes operator+(const Vec3Lanes& a, const Vec3Lanes& b) {
    return {a.x + b.x, a.y + b.y, a.z + b.z};
}
inline Vec3Lanes operator-(const Vec3Lanes& a, const Vec3Lanes& b) {
    return {a.x - b.x, a.y - b.y, a.z - b.z};
}
inline Vec3Lanes operator*(const Lane& s, const Vec3Lanes& a) {
    return {s * a.x, s * a.y, s * a.z};
}
inline Vec3Lanes operator*(double s, const Vec3Lanes& a) { return {s * a.x, s * a.y, s * a.z}; }
/// Component-wise product.
inline Vec3Lanes scaled(const Vec3Lanes& a, const Vec3Lanes& b) {
    return {a.x * b.x, a.y * b.y, a.z * b.z};
}
inline Vec3Lanes inverse(const Vec3Lanes& a) { return {1.0 / a.x, 1.0 / a.y, 1.0 / a.z}; }
inline Lane dot(const Vec3Lanes& a, const Vec3Lanes& b) {
    return a.x * b.x + a.y * b.y + a.z * b.z;
}
inline Vec3Lanes cross(const Vec3Lanes& a, const Vec3Lanes& b) {
    return {a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x};
}
inline Vec3Lanes select(LaneMask where, const Vec3Lanes& a, const Vec3Lanes& b) {
    return {where ? a.x : b.x, where ? a.y : b.y, where ? a.z : b.z};
}

inline Lane squared_norm(const QuatLanes& q) {
    return (q.x * q.x + q.y * q.y) + (q.z * q.z + q.w * q.w);
}
inline QuatLanes operator+(const QuatLanes& a, const QuatLanes& b) {
    return {a.x + b.x, a.y + b.y, a.z + b.z, a.w + b.w};
}
inline QuatLanes operator-(const QuatLanes& a, const QuatLanes& b) {
    return {a.x - b.x, a.y - b.y, a.z - b.z, a.w - b.w};
}
inline QuatLanes operator*(const QuatLanes& a, const QuatLanes& b) {
    return {a.w * b.x + a.x * b.w + a.y * b.z - a.z * b.y,
            a.w * b.y + a.y * b.w + a.z * b.x - a.x * b.z,
            a.w * b.z + a.z * b.w + a.x * b.y - a.y * b.x,
            a.w * b.w - a.x * b.x - a.y * b.y - a.z * b.z};
}
inline QuatLanes select(LaneMask where, const QuatLanes& a, const QuatLanes& b) {
    return {where ? a.x : b.x, where ? a.y : b.y, where ? a.z : b.z, where ? a.w : b.w};
}

/// Body axes for the unit quaternions `q`.
inline AxesLanes axes_of(const QuatLanes& q) {
    const Lane tx = 2.0 * q.x, ty = 2.0 * q.y, tz = 2.0 * q.z;
    const Lane xx = tx * q.x, yy = ty * q.y, zz = tz * q.z, xy = tx * q.y, xz = tx * q.z,
               yz = ty * q.z, wx = tx * q.w, wy = ty * q.w, wz = tz * q.w;
    return {{1.0 - (yy + zz), xy + wz, xz - wy},
            {xy - wz, 1.0 - (xx + zz), yz + wx},
            {xz + wy, yz - wx, 1.0 - (xx + yy)}};
}
inline Vec3Lanes to_world(const AxesLanes& axes, const Vec3Lanes& v) {
    return v.x * axes.x + v.y * axes.y + v.z * axes.z;
}
inline Vec3Lanes to_body(const AxesLanes& axes, const Vec3Lanes& v) {
    return {dot(axes.x, v), dot(axes.y, v), dot(axes.z, v)};
}

/// Unit quaternions of the rotation vectors `v` (rad), as exponential_map(Vec3).
inline QuatLanes exponential_map(const Vec3Lanes& v) {
    Vec3Lanes half = 0.5 * v;
    Lane squarings{}; // bounded, because an infinite value stays infinite
    for (LaneMask large = dot(half, half) > 1.0 / 16.0; bits(large) != 0;
         large = (dot(half, half) > 1.0 / 16.0) & (squarings < 64.0)) {
        half = select(large, 0.5 * half, half);
        squarings = large ? squarings + 1.0 : squarings;
    }
    const Lane x = dot(half, half), sinc = sinc_of_square(x);
    QuatLanes q{sinc * half.x, sinc * half.y, sinc * half.z, cosine_of_square(x)};
    for (; bits(squarings > 0.0) != 0; squarings -= 1.0) q = select(squarings > 0.0, q * q, q);
    return q;
}

/// Up to lane_count consecutive rows of a table.
struct LaneRows {
    Row first;
    int count;
};

/// Calls body(LaneRows) for groups of rows in [first, last).
template <class Body>
void for_lane_rows(Row first, Row last, Body&& body) {
    for (Row row = first; row < last; row += lane_count)
        body(LaneRows{row, static_cast<int>(std::min<Row>(lane_count, last - row))});
}

/// Calls `read` with a pointer to lane_count rows of `per_row` numbers: the column itself, or a
/// copy padded with zeros if the group is short.
template <std::size_t per_row, class Number, class Read>
[[gnu::always_inline]] inline auto read_rows(const Number* column, LaneRows rows, Read&& read) {
    alignas(64) std::array<Number, per_row * lane_count> padded;
    const Number* at = column + per_row * rows.first;
    if (rows.count < lane_count) {
        padded = {};
        std::memcpy(padded.data(), at,
                    per_row * sizeof(Number) * static_cast<std::size_t>(rows.count));
        at = padded.data();
    }
    return read(at);
}

/// Calls `write` to fill lane_count rows and keeps those that belong to the group.
template <std::size_t per_row, class Write>
[[gnu::always_inline]] inline void write_rows(double* column, LaneRows rows, Write&& write) {
    alignas(64) std::array<double, per_row * lane_count> padded;
    double* at = column + per_row * rows.first;
    const bool whole = rows.count == lane_count;
    write(whole ? at : padded.data());
    if (!whole)
        std::memcpy(at, padded.data(),
                    per_row * sizeof(double) * static_cast<std::size_t>(rows.count));
}

inline Lane load(const double* column, LaneRows rows) {
    return read_rows<1>(column, rows, [](const double* at) { return load_lane(at); });
}
inline Vec3Lanes load(const Vec3* column, LaneRows rows) {
    return read_rows<3>(column->data(), rows, [](const double* at) {
        const auto v = load_triples(at);
        return Vec3Lanes{v[0], v[1], v[2]};
    });
}
inline QuatLanes load(const Quat* column, LaneRows rows) {
    return read_rows<4>(column->coeffs().data(), rows, [](const double* at) {
        const auto q = transpose(load_rows([&](int k) { return at + 4 * k; }));
        return QuatLanes{q[0], q[1], q[2], q[3]};
    });
}
/// Mask of the lanes whose row holds `value`.
inline LaneMask equal(const std::uint32_t* column, LaneRows rows, std::uint32_t value) {
    return read_rows<1>(column, rows,
                        [&](const std::uint32_t* at) { return equal_lanes(at, value); });
}

inline void store(double* column, LaneRows rows, const Lane& value) {
    write_rows<1>(column, rows, [&](double* at) { store_lane(at, value); });
}
inline void store(Vec3* column, LaneRows rows, const Vec3Lanes& v) {
    write_rows<3>(column->data(), rows, [&](double* at) { store_triples(at, {v.x, v.y, v.z}); });
}
inline void store(Quat* column, LaneRows rows, const QuatLanes& q) {
    write_rows<4>(column->coeffs().data(), rows, [&](double* at) {
        store_rows(transpose({q.x, q.y, q.z, q.w}), lane_count, [&](int k) { return at + 4 * k; });
    });
}

} // namespace bris
