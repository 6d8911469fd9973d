#include "systems/loads/rail_beam.hpp"

#include "engine/errors.hpp"

#include <algorithm>
#include <functional>
#include <utility>

namespace bris {

namespace {

/// Stiffness of a beam for the deflections and slopes of its two ends.
Eigen::Matrix4d stiffness_of_span(double bending, double l) {
    Eigen::Matrix4d k;
    k.row(0) << 12, 6 * l, -12, 6 * l;
    k.row(1) << 6 * l, 4 * l * l, -6 * l, 2 * l * l;
    k.row(2) << -12, -6 * l, 12, -6 * l;
    k.row(3) << 6 * l, 2 * l * l, -6 * l, 4 * l * l;
    return bending / (l * l * l) * k;
}

/// Hermite's cubics at part `s` of a span: the deflection there by unit deflections and slopes of
/// the ends, and the forces and moments at the ends by a unit force there.
Eigen::Vector4d cubics(double s, double l) {
    return {1 - s * s * (3 - 2 * s), l * s * (1 - s) * (1 - s), s * s * (3 - 2 * s),
            -l * s * s * (1 - s)};
}

} // namespace

RailBeam::RailBeam(std::vector<double> at, double bending) : at_(std::move(at)), bending_(bending) {
    require(at_.size() > 1 && bending > 0 &&
                std::ranges::adjacent_find(at_, std::greater_equal<>()) == at_.end(),
            "rail: expected two ties or more at ascending places and a bending stiffness above 0");
}

std::size_t RailBeam::span_of(double x) const {
    const std::size_t none = at_.size() - 1;
    if (x == at_.front()) return 0;
    if (!(x > at_.front() && x <= at_.back())) return none;
    return static_cast<std::size_t>(std::ranges::lower_bound(at_, x) - at_.begin()) - 1;
}

Eigen::SparseMatrix<double> RailBeam::stiffness() const {
    std::vector<Eigen::Triplet<double>> entries;
    for (std::size_t i = 0; i + 1 < at_.size(); ++i) {
        const auto first = static_cast<int>(2 * i);
        const Eigen::Matrix4d span = stiffness_of_span(bending_, at_[i + 1] - at_[i]);
        for (int row = 0; row < 4; ++row)
            for (int column = 0; column < 4; ++column)
                entries.emplace_back(first + row, first + column, span(row, column));
    }
    Eigen::SparseMatrix<double> k(2 * nodes(), 2 * nodes());
    k.setFromTriplets(entries.begin(), entries.end());
    return k;
}

void RailBeam::add_force(double x, double force, Eigen::VectorXd& at_nodes) const {
    const std::size_t i = span_of(x);
    if (i + 1 == at_.size()) return;
    const double l = at_[i + 1] - at_[i];
    at_nodes.segment<4>(2 * static_cast<Eigen::Index>(i)) += force * cubics((x - at_[i]) / l, l);
}

void RailBeam::add_line_load(double load, Eigen::VectorXd& at_nodes) const {
    for (std::size_t i = 0; i + 1 < at_.size(); ++i) {
        const double l = at_[i + 1] - at_[i], force = load * l;
        at_nodes.segment<4>(2 * static_cast<Eigen::Index>(i)) +=
            Eigen::Vector4d(force / 2, force * l / 12, force / 2, -force * l / 12);
    }
}

double RailBeam::deflection(double x, const Eigen::VectorXd& of_nodes) const {
    const std::size_t i = span_of(x);
    if (i + 1 == at_.size()) return 0;
    const double l = at_[i + 1] - at_[i];
    return cubics((x - at_[i]) / l, l).dot(of_nodes.segment<4>(2 * static_cast<Eigen::Index>(i)));
}

} // namespace bris
