// Waves in a straight chain of beads: a standing wave in a compressed chain, or the solitary wave
// in a chain of beads that just touch.
#include "scenarios/verification/chain.hpp"

#include "engine/errors.hpp"
#include "engine/io/csv.hpp"
#include "engine/scenario.hpp"
#include "engine/summary.hpp"
#include "scenarios/verification/names.hpp"

namespace {

using namespace bris;

Material bead() {
    Material m;
    m.name = "bead";
    m.density = 2600;
    m.young_modulus = 5e9;
    m.poisson_ratio = 0.25;
    m.normal_stiffness = 2e5;
    return m;
}

struct Chain {
    ChainWave wave;
    ChainPulse pulse;
    MaterialOptions material{bead()};
    std::string kind = "pulse", law = "hertz_frictionless";
    unsigned beads = 100;
    double radius = 0.01, step = 0.01;

    void describe(auto& option) {
        option("kind", kind, "",
               "Experiment. pulse: the first bead is thrown at a chain of beads that just touch. "
               "wave: a compressed chain between two held beads oscillates in a standing wave.",
               {"pulse", "wave"});
        option("law", law, "", "Contact law.", law_choices());
        option("beads", beads, "", "Number of moving beads.", within(1, 10000));
        option("radius", radius, "m", "Radius of a bead.", above(0, 1e3));
        option("step", step, "",
               "Time step. In a pulse it is a fraction of (m^2/(K^2 v0))^(1/5) (linear laws: of "
               "sqrt(m/k)), in a wave a fraction of sqrt(m/k).",
               above(0, 1));
        material.describe(option, "", "of the beads");
        option.group("Pulse");
        option("speed", pulse.speed, "m/s", "Initial speed of the first bead.", above(0, 1e4));
        option("front", pulse.front, "",
               "Position along the chain, as a fraction of its length, at which the pulse is timed "
               "first.",
               above(0, 1));
        option("rear", pulse.rear, "",
               "Position along the chain, as a fraction of its length, at which the pulse is timed "
               "last.",
               between(0, 1));
        option.group("Wave");
        option("mode", wave.mode, "", "Number of half waves in the chain.", within(1, 10000));
        option("overlap", wave.overlap, "",
               "Overlap of neighbouring beads before the wave, as a fraction of the radius.",
               above(0, 0.5));
        option("amplitude", wave.amplitude, "",
               "Amplitude of the wave, as a fraction of the overlap.", above(0, 0.4));
        option("periods", wave.periods, "", "Simulated time, in periods of the wave.",
               above(0.1, 1e6));
    }
};

ChainPulse pulse_of(const Chain& s) {
    ChainPulse pulse = s.pulse;
    pulse.beads = s.beads;
    pulse.radius = s.radius;
    pulse.step = s.step;
    pulse.law = law_named(s.law);
    pulse.material = s.material.material;
    return pulse;
}

ChainWave wave_of(const Chain& s) {
    ChainWave wave = s.wave;
    wave.beads = s.beads;
    wave.radius = s.radius;
    wave.step = s.step;
    wave.law = law_named(s.law);
    wave.material = s.material.material;
    return wave;
}

Summary pulse_results(const ChainPulse& pulse, const Common& common) {
    const ChainPulseResult r = run_experiment(pulse);
    std::vector<std::vector<double>> rows;
    for (std::size_t i = 0; i < r.arrival.size(); ++i)
        rows.push_back({static_cast<double>(i), r.arrival[i] * r.time_unit});
    write_csv(common.out / "arrival.csv", {"contact", "time_of_largest_force_s"}, rows);
    Summary t;
    t.add("pulse_speed_beads_per_time_unit", r.pulse_speed);
    t.add("largest_force_over_unit", r.largest_force);
    t.add("largest_bead_velocity_over_v0", r.largest_velocity);
    if (is_hertz(pulse.law))
        t.add("pulse_speed_over_sixth_root_of_force",
              r.pulse_speed / std::pow(r.largest_force, 1.0 / 6));
    t.add("time_unit_s", r.time_unit);
    t.add("momentum_change", r.momentum_change);
    t.add("steps", r.steps);
    return t;
}

Summary wave_results(const ChainWave& wave) {
    const ChainWaveResult r = run_experiment(wave);
    Summary t;
    t.add("frequency_rad_per_s", r.frequency);
    t.add("exact_frequency_rad_per_s", r.exact_frequency);
    t.add("leapfrog_frequency_rad_per_s", r.discrete_frequency);
    t.add("frequency_error", r.frequency / r.exact_frequency - 1);
    t.add("error_against_leapfrog", r.frequency / r.discrete_frequency - 1);
    t.add("amplitude_drift", r.amplitude_drift);
    t.add("contact_stiffness_N_per_m", r.stiffness);
    t.add("steps", r.steps);
    return t;
}

bool is_pulse(const Chain& settings) { return settings.kind == "pulse"; }

void check_options(const Chain& settings, const Common&) {
    is_pulse(settings) ? check(pulse_of(settings)) : check(wave_of(settings));
}

void run(const Chain& settings, const Common& common) {
    const Summary results = is_pulse(settings) ? pulse_results(pulse_of(settings), common)
                                               : wave_results(wave_of(settings));
    report_results(common, results);
}

std::string explain(const Chain& settings, const Common&) {
    return explain_step(law_named(settings.law), Grains::spheres);
}

} // namespace

int main(int argc, char** argv) {
    return run_scenario<Chain>(
        argc, argv,
        {"chain", "Waves in a straight chain of beads.", "a run of a chain takes only a moment"},
        check_options, run, explain);
}
