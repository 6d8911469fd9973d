#include "scenarios/triaxial/load_cycles.hpp"

#include "engine/errors.hpp"
#include "engine/math.hpp"

#include <fmt/format.h>

#include <algorithm>

namespace bris {

double LoadCycles::level_after(std::uint64_t halves) const {
    if (halves == 0) return 0;
    if (halves % 2 == 0) return least_q;
    const double cycle = 0.5 * static_cast<double>(halves + 1);
    const double grown = ramp_cycles > 0 ? std::min(1.0, cycle / ramp_cycles) : 1;
    return least_q + grown * (largest_q - least_q);
}

double LoadCycles::rest_after(std::uint64_t halves) const {
    const bool rests =
        rest_every > 0 && halves > 0 && halves % (2 * std::uint64_t{rest_every}) == 0;
    return rests ? rest : 0;
}

void check_cycles(const LoadCycles& c, LawName law, double least_pressure) {
    if (!c.are_given()) return;
    require(c.least_q < c.largest_q,
            fmt::format("--least-q: expected less than --largest-q, found {:g} and {:g} Pa",
                        c.least_q, c.largest_q));
    require(c.least_q > -least_pressure,
            fmt::format("--least-q: expected above minus the confining pressure of {:g} Pa, as the "
                        "platen cannot pull, found {:g} Pa",
                        least_pressure, c.least_q));
    require(
        c.platen_mass == 0 || !c.are_quasi_static(),
        "--platen-mass: expected a --frequency above 0, as quasi-static cycles have no inertia");
    require(
        c.restitution == 1 || has_dashpots(law),
        fmt::format("--restitution: expected a --law with dashpots, such as linear_edges, found "
                    "{}",
                    traits(law).name));
    require(
        (c.rest_every == 0) == (c.rest == 0),
        fmt::format("--rest-every, --rest: expected both or neither, found {} cycles and {:g} s",
                    c.rest_every, c.rest));
    require(c.rest == 0 || !c.are_quasi_static(),
            "--rest: expected a --frequency above 0, as quasi-static cycles come to rest anyway");
}

namespace {

/// Area (Pa) of the loop of q over axial strain, closed by a line.
double loop_area(const std::vector<double>& strain, const std::vector<double>& q) {
    double area = 0;
    for (std::size_t k = 0; k < q.size(); ++k) {
        const std::size_t next = (k + 1) % q.size();
        area += 0.5 * (q[k] + q[next]) * (strain[next] - strain[k]);
    }
    return area;
}

} // namespace

CyclicResponse response_of(const SeriesOf<LoadPoint>& points, double unbalanced_ratio) {
    using P = LoadPoint;
    const auto &strain = points[&P::axial_strain], &volume = points[&P::volumetric_strain],
               &q = points[&P::q], &errors = points[&P::worst_ring_error];
    const auto most = static_cast<std::size_t>(std::ranges::max_element(strain) - strain.begin());
    const double recovered = strain[most] - strain.back(), fall = q[most] - q.back();
    const auto [least_q, largest_q] = std::ranges::minmax_element(q.begin() + 1, q.end());
    return {.cycle = points[&P::cycle].back(),
            .time = points[&P::time].back(),
            .axial_strain = strain.back(),
            .volumetric_strain = volume.back(),
            .largest_axial_strain = strain[most],
            .least_q = *least_q,
            .largest_q = *largest_q,
            .resilient_modulus = fall / recovered,
            .poisson_ratio = 0.5 * (1 - (volume[most] - volume.back()) / recovered),
            .damping_ratio = 2 * loop_area(strain, q) / (pi * fall * recovered),
            .worst_ring_error = *std::max_element(errors.begin() + 1, errors.end()),
            .unbalanced_ratio = unbalanced_ratio};
}

bool is_shown_cycle(std::uint64_t cycle) {
    if (cycle == 0) return false;
    while (cycle % 10 == 0) cycle /= 10;
    return cycle == 1 || cycle == 2 || cycle == 5;
}

void CyclicState::save(Archive& archive) const {
    if (!has_begun()) return;
    const std::array<std::uint64_t, 2> counts{halves, points};
    archive.put("triaxial/cycles", std::span<const std::uint64_t>(counts));
    put_fields(archive, "triaxial/cycles_began", std::tie(began));
    present.save(archive);
    loops.save(archive);
    responses.save(archive);
}

void CyclicState::load(const Archive& archive) {
    *this = {};
    if (archive.find("triaxial/cycles") == nullptr) return;
    const auto counts = archive.get<std::uint64_t>("triaxial/cycles");
    halves = counts.at(0);
    points = counts.at(1);
    get_fields(archive, "triaxial/cycles_began", std::tie(began));
    present.load(archive);
    loops.load(archive);
    responses.load(archive);
}

} // namespace bris
