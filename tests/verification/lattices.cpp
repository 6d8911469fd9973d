#include "scenarios/specimens/small_scene.hpp"
#include "tests/verification/cases.hpp"
#include "tests/verification/chain.hpp"
#include "tests/verification/crystal.hpp"
#include "tests/verification/crystal_wave.hpp"

#include <fmt/format.h>

namespace bris::detail {

void verify_chains(Checks& checks) {
    for (const unsigned mode : {1u, 8u, 16u, 31u})
        for (const double step : {0.1, 0.5}) {
            ChainWave s;
            s.mode = mode;
            s.step = step;
            s.material = linear_material(1e5);
            const ChainWaveResult r = run_experiment(s);
            checks.relative(
                fmt::format("linear chain, mode {} of 31, dt = {} sqrt(m/k): frequency of the "
                            "leapfrog",
                            mode, step),
                "rad/s", r.discrete_frequency, r.frequency, 1e-12);
        }
    ChainWave hertz;
    hertz.law = LawName::hertz_frictionless;
    hertz.material.density = 2600;
    hertz.material.young_modulus = 5e9;
    hertz.material.poisson_ratio = 0.25;
    hertz.amplitude = 1e-3;
    hertz.overlap = 1e-3;
    hertz.mode = 8;
    const ChainWaveResult wave = run_experiment(hertz);
    checks.relative("precompressed Hertz chain, mode 8 of 31: frequency of the leapfrog", "rad/s",
                    wave.discrete_frequency, wave.frequency, 1e-6);

    // exact values from an independent integration of the chain in fine steps
    ChainPulse pulse;
    pulse.material = hertz.material;
    const ChainPulseResult r = run_experiment(pulse);
    checks.relative("Nesterenko's solitary wave: speed", "beads/time", 0.8405089136297338,
                    r.pulse_speed, 1e-4, 0.012);
    checks.relative("Nesterenko's solitary wave: largest contact force", "", 0.6395548312578665,
                    r.largest_force, 1e-4);
    checks.relative("Nesterenko's solitary wave: largest bead velocity", "", 0.6816313746928143,
                    r.largest_velocity, 1e-4);
    checks.relative("Nesterenko's solitary wave: speed / force^(1/6)", "", 0.9055157867054164,
                    r.pulse_speed / std::pow(r.largest_force, 1.0 / 6), 1e-4, 0.012);
    checks.absolute("Nesterenko's solitary wave: change of momentum", "", 0, r.momentum_change,
                    1e-12);
}

namespace {

const char* name_of(CrystalLattice lattice) {
    return lattice == CrystalLattice::simple
               ? "SC"
               : (lattice == CrystalLattice::body_centred ? "BCC" : "FCC");
}

struct Moduli {
    CrystalLattice lattice;
    double pressure, c11, c12, c44;
};
// closed forms for spheres of diameter 40 mm and Young's modulus 5 GPa, Pa
constexpr Moduli hertzian[]{
    {CrystalLattice::simple, 110e3, 1.05472799e+08, 0, 4.52026280e+07},
    {CrystalLattice::face_centred, 10e3, 8.80754533e+07, 3.38751743e+06, 4.40377266e+07},
    {CrystalLattice::face_centred, 110e3, 1.95878055e+08, 7.53377133e+06, 9.79390273e+07}};

struct LinearModuli {
    CrystalLattice lattice;
    double ratio, c11, c12, c44;
};
// closed forms in units of kn / d
constexpr LinearModuli linear[]{
    {CrystalLattice::simple, 0.5, 1, 0, 0.25},
    {CrystalLattice::body_centred, 0, 0.577350269, 0.577350269, 0.577350269},
    {CrystalLattice::body_centred, 0.8, 1.501110700, 0.115470054, 0.808290377},
    {CrystalLattice::face_centred, 0, 1.414213562, 0.707106781, 0.707106781},
    {CrystalLattice::face_centred, 0.5, 2.121320344, 0.353553391, 1.060660172},
    {CrystalLattice::face_centred, 1, 2.828427125, 0, 1.414213562}};

void check_moduli(Checks& checks, const std::string& name, const CrystalResult& r, double scale,
                  const Vec3& exact, double tolerance) {
    checks.relative(name + ": C11", scale == 1 ? "Pa" : "kn/d", exact[0], r.c11 / scale, tolerance);
    // a modulus of zero is compared with the largest modulus
    if (exact[1] == 0)
        checks.absolute(name + ": C12 over C11", "", 0, r.c12 / r.c11, tolerance);
    else
        checks.relative(name + ": C12", scale == 1 ? "Pa" : "kn/d", exact[1], r.c12 / scale,
                        tolerance);
    checks.relative(name + ": C44", scale == 1 ? "Pa" : "kn/d", exact[2], r.c44 / scale, tolerance);
}

} // namespace

void verify_crystals(Checks& checks) {
    double soft = 0, stiff = 0;
    for (const Moduli& m : hertzian) {
        Crystal s;
        s.lattice = m.lattice;
        s.pressure = m.pressure;
        s.material.young_modulus = 5e9;
        s.material.poisson_ratio = 0.25;
        s.material.friction = 10;
        const CrystalResult r = run_experiment(s);
        check_moduli(
            checks, fmt::format("Hertz-Mindlin {}, {:g} kPa", name_of(m.lattice), m.pressure / 1e3),
            r, 1, Vec3(m.c11, m.c12, m.c44), 1e-3);
        if (m.lattice == CrystalLattice::face_centred) (soft == 0 ? soft : stiff) = r.bulk;
    }
    checks.absolute("Hertz-Mindlin FCC: exponent of pressure in the bulk modulus", "", 1.0 / 3,
                    std::log(stiff / soft) / std::log(11.0), 1e-3);
    for (const LinearModuli& m : linear) {
        Crystal s;
        s.lattice = m.lattice;
        s.law = LawName::linear;
        const double kn = 1e9;
        s.material = linear_material(kn, m.ratio * kn, 10);
        check_moduli(checks, fmt::format("linear {}, ks/kn = {}", name_of(m.lattice), m.ratio),
                     run_experiment(s), kn / s.spacing, Vec3(m.c11, m.c12, m.c44), 1e-6);
    }
}

void verify_waves(Checks& checks) {
    // dispersion alone reduces the speed by 0.2 % for a wave of that length, by 0.6 % for its group
    const auto check = [&](const std::string& name, const Crystal& crystal, double c11,
                           double c44) {
        const double density = crystal.material.density * pi / 6 / cell_volume(crystal.lattice);
        for (const bool shear : {false, true}) {
            const CrystalWaveResult r = run_experiment(CrystalWave{
                .crystal = crystal, .motion = shear ? Vec3(Vec3::UnitY()) : Vec3(Vec3::UnitX())});
            checks.relative(name + (shear ? ": speed of a shear wave of length 20 d along [100]"
                                          : ": speed of a pressure wave of length 20 d along "
                                            "[100]"),
                            "m/s", std::sqrt((shear ? c44 : c11) / density), r.speed, 1e-2);
        }
    };
    Crystal hertz; // diameter 40 mm, Young's modulus 5 GPa: 315.9 and 223.4 m/s
    hertz.material.density = 2650;
    hertz.material.young_modulus = 5e9;
    hertz.material.poisson_ratio = 0.25;
    hertz.material.friction = 10;
    check("Hertz-Mindlin FCC, 110 kPa", hertz, hertzian[2].c11, hertzian[2].c44);
    Crystal springs;
    springs.law = LawName::linear;
    const double kn = 1e7, scale = kn / springs.spacing;
    springs.material = linear_material(kn, linear[4].ratio * kn, 10);
    check(fmt::format("linear FCC, ks/kn = {}", linear[4].ratio), springs, linear[4].c11 * scale,
          linear[4].c44 * scale);
}

void verify_stability(Checks& checks) {
    const auto limit = [](std::vector<Neighbour> around, double ratio) {
        return run_experiment(StabilityLimit{.around = std::move(around), .shear_ratio = ratio});
    };
    // the bisection stops at 2e-4; the published limits have three to six digits
    constexpr double tolerance = 1e-3;
    checks.relative("sphere on a fixed partner, ks = 0: largest stable step", "sqrt(m/kn)", 2,
                    limit(one_held(), 0), tolerance, 0.02);
    checks.relative("sphere on a fixed partner, ks = kn: largest stable step", "sqrt(m/kn)", 1.0690,
                    limit(one_held(), 1), tolerance, 0.02);
    checks.relative("free pair, ks = 0: largest stable step", "sqrt(m/kn)", std::sqrt(2.0),
                    limit(free_pair(), 0), tolerance, 0.02);
    checks.relative("free pair, ks = kn: largest stable step", "sqrt(m/kn)", 2 / std::sqrt(7.0),
                    limit(free_pair(), 1), tolerance, 0.02);
    struct Limit {
        CrystalLattice lattice;
        double ratio, step;
    };
    // limits from lattice dynamics, as 2 / omega of the highest frequency
    constexpr Limit list[]{{CrystalLattice::simple, 0, 1},
                           {CrystalLattice::simple, 2.0 / 7, 0.7977},
                           {CrystalLattice::simple, 0.5, 0.632456},
                           {CrystalLattice::simple, 1, 0.447214},
                           {CrystalLattice::body_centred, 0, 0.866140},
                           {CrystalLattice::body_centred, 2.0 / 7, 0.6909},
                           {CrystalLattice::body_centred, 0.8, 0.433013},
                           {CrystalLattice::body_centred, 1, 0.387298},
                           {CrystalLattice::face_centred, 0, 0.707107},
                           {CrystalLattice::face_centred, 2.0 / 7, 0.5916},
                           {CrystalLattice::face_centred, 0.5, 0.447214},
                           {CrystalLattice::face_centred, 1, 0.316228}};
    for (const Limit& l : list) {
        const double found =
            std::min(limit(in_phase(l.lattice), l.ratio), limit(zone_boundary(l.lattice), l.ratio));
        checks.relative(
            fmt::format("{}, ks/kn = {:.3g}: largest stable step", name_of(l.lattice), l.ratio),
            "sqrt(m/kn)", l.step, found, tolerance, 0.02);
    }
}

} // namespace bris::detail
