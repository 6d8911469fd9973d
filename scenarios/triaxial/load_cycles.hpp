#pragma once

#include "components/law.hpp"
#include "engine/io/series.hpp"
#include "engine/options.hpp"

#include <array>
#include <cstdint>
#include <string>
#include <vector>

namespace bris {

/// Load cycles of a triaxial test: the deviatoric stress q goes from 0 to its largest value, and
/// then to and fro between the least and the largest one along a cosine.
struct LoadCycles {
    unsigned count = 0;                       ///< 0: none, the test is monotonic
    double least_q = 10e3, largest_q = 230e3; ///< Pa; below 0: extension
    double frequency = 5;                     ///< Hz, at the true masses; 0: quasi-static
    unsigned half_steps = 2000;   ///< of a quasi-static half cycle, before it comes to rest
    std::string area = "nominal"; ///< or "present"
    double platen_mass = 0;       ///< kg; 0: as light as the time step allows
    double restitution = 1;       ///< between rocks
    double damping = -1;          ///< local, of the rocks; below 0: that of the test
    double ramp_cycles = 0;       ///< over which the largest q grows
    unsigned rest_every = 0;      ///< cycles; 0: no rest
    double rest = 0;              ///< s, at the least q
    double largest_strain = 0.3;  ///< axial, at which the test ends

    bool are_given() const { return count > 0; }
    bool are_quasi_static() const { return frequency == 0; }
    /// Deviatoric stress (Pa) after so many half cycles.
    double level_after(std::uint64_t halves) const;
    /// Rest (s) after so many half cycles.
    double rest_after(std::uint64_t halves) const;

    void declare_options(auto& option) {
        option.group("Load cycles");
        option("cycles", count, "",
               "Number of load cycles, instead of compression at a given displacement; 0: none.",
               within(0, 1e7));
        option("least_q", least_q, "Pa",
               "Least deviatoric stress of the cycles; below 0 the specimen is extended.",
               within(-1e9, 1e9).usually(-1e6, 1e7));
        option("largest_q", largest_q, "Pa", "Largest deviatoric stress of the cycles.",
               within(-1e9, 1e9).usually(1e3, 1e7));
        option("frequency", frequency, "Hz",
               "Frequency of the cycles, with the true masses; 0: quasi-static, with scaled masses "
               "unless --mass-scaling is off, and at rest at both ends of a cycle.",
               within(0, 1000));
        option("half_steps", half_steps, "",
               "Number of steps of a quasi-static half cycle before it comes to rest.",
               within(100, 1e7));
        option(
            "load_area", area, "",
            "Area on which --least-q and --largest-q are meant: nominal, that before the cycles, "
            "as a test machine that controls the force; present, that of the deformed specimen.",
            {"nominal", "present"});
        option(
            "platen_mass", platen_mass, "kg",
            "Mass of the top platen with what moves with it; 0: as light as the time step allows, "
            "with strong damping, so that it exerts the load without delay.",
            within(0, 1e6));
        option("restitution", restitution, "",
               "Coefficient of restitution of contacts between rocks during the cycles; 1: they "
               "have no dashpots. The specimen is prepared and consolidated without.",
               within(0, 1));
        option("cycle_damping", damping, "",
               "Coefficient of local damping during the cycles, which also weakens inertia; below "
               "0: that of --damping.",
               within(-1, 0.95));
        option("ramp_cycles", ramp_cycles, "",
               "Number of cycles over which the largest stress grows to its full value; 0: none.",
               within(0, 1e6));
        option("rest_every", rest_every, "",
               "Number of cycles between periods of rest at the least stress; 0: no rest.",
               within(0, 1e7));
        option("rest", rest, "s", "Duration of a rest.", within(0, 1e4));
        option("largest_axial_strain", largest_strain, "",
               "Axial strain at which the cycles end before their number is reached.",
               within(1e-3, 0.3));
    }
};

/// Throws InputError, naming the option, if the cycles contradict each other, the contact law or
/// the least of the confining pressures (Pa).
void check_cycles(const LoadCycles& cycles, LawName law, double least_pressure);

/// A moment of a cyclic test. Compression is positive; stresses are those of the boundaries.
struct LoadPoint {
    double cycle; ///< since the first began, with its fraction
    double time;  ///< s, likewise
    double q, axial_strain, volumetric_strain, worst_ring_error;
    static constexpr auto columns() {
        using P = LoadPoint;
        return std::array{Sampled{&P::cycle, "cycle", ""},
                          Sampled{&P::time, "time", "s"},
                          Sampled{&P::q, "deviatoric_stress", "Pa"},
                          Sampled{&P::axial_strain, "axial_strain", ""},
                          Sampled{&P::volumetric_strain, "volumetric_strain", ""},
                          Sampled{&P::worst_ring_error, "worst_ring_error", ""}};
    }
};

/// What a specimen does in one load cycle.
struct CyclicResponse {
    double cycle;
    double time;                            ///< s, at its end, since the first began
    double axial_strain, volumetric_strain; ///< at its end, so permanent
    double largest_axial_strain;
    double least_q, largest_q; ///< Pa, as met
    /// Pa, fall of q over fall of the axial strain from its largest value to the end of the cycle.
    double resilient_modulus;
    double poisson_ratio; ///< minus the fall of the radial strain over that of the axial one
    /// Area of the loop, closed by a line, over 4 pi times the energy 1/2 (q/2) (strain/2) of the
    /// ranges of q and resilient strain. In the first cycles it has the work of permanent strain.
    double damping_ratio;
    double worst_ring_error, unbalanced_ratio; ///< of all points; at its end
    static constexpr auto columns() {
        using R = CyclicResponse;
        return std::array{Sampled{&R::cycle, "cycle", ""},
                          Sampled{&R::time, "time", "s"},
                          Sampled{&R::axial_strain, "axial_strain", ""},
                          Sampled{&R::volumetric_strain, "volumetric_strain", ""},
                          Sampled{&R::largest_axial_strain, "largest_axial_strain", ""},
                          Sampled{&R::least_q, "least_q", "Pa"},
                          Sampled{&R::largest_q, "largest_q", "Pa"},
                          Sampled{&R::resilient_modulus, "resilient_modulus", "Pa"},
                          Sampled{&R::poisson_ratio, "poisson_ratio", ""},
                          Sampled{&R::damping_ratio, "damping_ratio", ""},
                          Sampled{&R::worst_ring_error, "worst_ring_error", ""},
                          Sampled{&R::unbalanced_ratio, "unbalanced_ratio", ""}};
    }
};

/// The response of a cycle from its points, of which the first is the last one of the cycle before.
CyclicResponse response_of(const SeriesOf<LoadPoint>& cycle, double unbalanced_ratio);

/// 1, 2, 5, 10, 20, 50 and so on: the cycles of which loops, stages and frames are kept.
bool is_shown_cycle(std::uint64_t cycle);

/// A cyclic test so far, as part of TriaxialState.
struct CyclicState {
    std::uint64_t halves = 0, points = 0; ///< finished half cycles, and points of the present one
    double began = 0;                     ///< s, of the Clock
    SeriesOf<LoadPoint> present{"present_cycle"}, loops{"loops"};
    SeriesOf<CyclicResponse> responses{"cycles"};

    bool has_begun() const { return present.rows() > 0; }
    void save(Archive& archive) const;
    void load(const Archive& archive); ///< if a cyclic test had begun
};

} // namespace bris
