#include "scenarios/track/coupled_track.hpp"

#include "engine/ensemble.hpp"
#include "engine/errors.hpp"
#include "engine/interrupt.hpp"
#include "engine/io/checkpoint.hpp"
#include "engine/resume.hpp"
#include "engine/run.hpp"
#include "scenarios/ballast_box/box_run.hpp"
#include "scenarios/track/bay.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <memory>

namespace bris {

namespace {

namespace fs = std::filesystem;

constexpr unsigned longest_block = 10; // axles
constexpr auto checkpoint_name = "track.ckpt.h5";

/// The bed of a tie has a folder, a packing and a thread of its own.
Common common_of_bed(const Common& common, std::size_t tie) {
    Common own = common;
    own.out = common.out / fmt::format("tie_{:02}", tie + 1);
    own.resume.clear();
    own.threads = 1;
    own.seed = 1000 * common.seed + tie;
    return own;
}

/// The settings on which a bay depends: those of its box.
Common of_box(const BallastBox& box, Common own) {
    BallastBox described = box;
    Options options;
    described.declare_ballast_options(options);
    described.fouling.declare_options(options);
    own.settings = options.values();
    own.settings.emplace_back("run", box.run);
    own.settings.emplace_back("fines", box.fines);
    own.settings.emplace_back("steps_per_cycle", box.steps_per_cycle);
    return own;
}

void put_history(Archive& archive, const CoupledHistory& history) {
    std::vector<double> states, blocks;
    for (const StretchState& s : history.states) {
        states.insert(states.end(), {s.settled, s.cycles});
        for (const auto* of_ties : {&s.settlements, &s.voids, &s.loads, &s.profile})
            states.insert(states.end(), of_ties->begin(), of_ties->end());
    }
    for (const BayBlock& b : history.blocks)
        blocks.insert(blocks.end(),
                      {static_cast<double>(b.tie), b.cycles, b.load, b.settlement, b.stiffness});
    archive.put("track/states", std::span<const double>(states));
    archive.put("track/blocks", std::span<const double>(blocks));
}

CoupledHistory get_history(const Archive& archive, std::size_t ties) {
    CoupledHistory history;
    const auto states = archive.get<double>("track/states"),
               blocks = archive.get<double>("track/blocks");
    for (auto next = states.begin(); next != states.end();) {
        StretchState& s = history.states.emplace_back();
        s.settled = *next++;
        s.cycles = *next++;
        for (auto* of_ties : {&s.settlements, &s.voids, &s.loads, &s.profile}) {
            of_ties->assign(next, next + static_cast<std::ptrdiff_t>(ties));
            next += static_cast<std::ptrdiff_t>(ties);
        }
    }
    for (auto next = blocks.begin(); next != blocks.end(); next += 5)
        history.blocks.push_back(
            {static_cast<std::size_t>(next[0]), next[1], next[2], next[3], next[4]});
    return history;
}

class Coupling {
public:
    Coupling(const CoupledTrack& track, const MakeBed& bed_of, const Common& common,
             const std::vector<std::string_view>& may_differ)
        : track_(track), common_(common), may_differ_(may_differ), stretch_(track.stretch),
          rates_(track.law.rates(track.stretch, common.seed)), progress_(make_progress(common)) {
        for (std::size_t i = 0; i < track.stretch.ties; ++i)
            if (track.has_bay(i)) ties_.push_back(i);
        for (const std::size_t tie : ties_) {
            const Common own = common_of_bed(common, tie);
            fs::create_directories(own.out);
            bays_.push_back(bed_of(tie, own));
            folders_.push_back(own.out);
        }
    }

    CoupledHistory run() {
        if (common_.resume.empty())
            begin();
        else
            resume();
        while (done_ < track_.cycles) {
            advance();
            report("couple", static_cast<double>(done_) / track_.cycles);
        }
        progress_.report(0, {});
        return history_;
    }

private:
    void report(const std::string& phase, double part) {
        progress_.report(0, {phase, part, fmt::format("axle {} of {}", done_, track_.cycles)});
    }
    /// All bays at once, each on one thread.
    void for_bays(const std::function<void(std::size_t)>& visit) {
        run_ensemble(bays_.size(), common_.threads, visit);
    }

    void begin() {
        for_bays([&](std::size_t k) {
            bays_[k]->prepare(progress_slot(progress_, static_cast<unsigned>(k)));
        });
        note();
    }

    void advance() {
        const std::vector<double> loads = loads_of_ties();
        const unsigned axles = block_length();
        std::vector<double> by(track_.stretch.ties, 0);
        for_bays([&](std::size_t k) {
            const double of_rails = loads[ties_[k]] - weight_of_tie;
            if (of_rails > 2 * dead_load) by[ties_[k]] = bays_[k]->load(of_rails, axles);
        });
        const double good = settlement_of_good_tie(by, loads);
        for (std::size_t i = 0; i < by.size(); ++i)
            if (!track_.has_bay(i)) by[i] = rates_[i] * good * over_even(loads[i]);
        fastest_ = std::max(std::abs(good), std::ranges::max(by)) / axles;
        done_ += axles;
        stretch_.settle(by, good);
        for (std::size_t k = 0; k < bays_.size(); ++k)
            history_.blocks.push_back({ties_[k], static_cast<double>(done_), loads[ties_[k]],
                                       stretch_.settlements()[ties_[k]], bays_[k]->stiffness()});
        take_stiffness();
        note();
        save();
    }

    std::vector<double> loads_of_ties() {
        std::vector<double> loads;
        for (std::size_t i = 0; i < track_.stretch.ties; ++i) loads.push_back(stretch_.load(i));
        return loads;
    }
    double over_even(double load) const {
        return std::pow(load / stretch_.even_load(), track_.law.exponent);
    }
    /// Mean of the good bays, brought to the load of an even track by the law.
    double settlement_of_good_tie(const std::vector<double>& by, const std::vector<double>& loads) {
        double sum = 0, bays = 0;
        for (const std::size_t tie : ties_)
            if (!track_.stretch.is_mud(tie) && loads[tie] > 0.2 * stretch_.even_load()) {
                sum += by[tie] / over_even(loads[tie]);
                ++bays;
            }
        return bays > 0 ? sum / bays : 0;
    }
    /// Axles until the level of some tie will have changed by what a block may, as in the last one.
    unsigned block_length() const {
        const double most = track_.block * stretch_.even_load() / track_.stretch.tie_support,
                     axles = fastest_ > 0 ? most / fastest_ : 1;
        const auto wanted =
            static_cast<unsigned>(std::clamp(axles, 1.0, static_cast<double>(longest_block)));
        return std::min(wanted, track_.cycles - done_);
    }

    /// Pads in series with bed and subgrade as measured; ties without a bay as the good bays.
    void take_stiffness() {
        const auto with_pads = [&](double bed) { return in_series(bed, track_.pad_stiffness); };
        double sum = 0, bays = 0;
        for (std::size_t k = 0; k < bays_.size(); ++k)
            if (!track_.stretch.is_mud(ties_[k]) && bays_[k]->stiffness() > 0) {
                sum += with_pads(bays_[k]->stiffness());
                ++bays;
            }
        if (bays == 0) return;
        std::vector<double> of_ties(track_.stretch.ties, sum / bays);
        for (std::size_t k = 0; k < bays_.size(); ++k)
            if (bays_[k]->stiffness() > 0) of_ties[ties_[k]] = with_pads(bays_[k]->stiffness());
        stretch_.set_stiffness(of_ties, sum / bays);
    }
    void note() {
        StretchState state = stretch_.state();
        state.cycles = done_;
        history_.states.push_back(std::move(state));
    }

    static fs::path bay_file(const fs::path& folder, unsigned axles) {
        return folder / fmt::format("bay_{}.ckpt.h5", axles);
    }
    /// First the bays, then the stretch, which names their files; then the older ones go.
    void save() {
        const Saving saving;
        for (std::size_t k = 0; k < bays_.size(); ++k) bays_[k]->save(bay_file(folders_[k], done_));
        Checkpoint checkpoint{common_.scenario, done_, common_.settings, {}};
        const double settled = stretch_.settled();
        put_fields(
            checkpoint.state, "track/numbers",
            std::tuple<const unsigned&, const double&, const double&>(done_, fastest_, settled));
        checkpoint.state.put("track/levels", std::span<const double>(stretch_.settlements()));
        put_history(checkpoint.state, history_);
        write_checkpoint(common_.out / checkpoint_name, checkpoint);
        if (saved_ > 0 && saved_ != done_)
            for (const fs::path& folder : folders_) fs::remove(bay_file(folder, saved_));
        saved_ = done_;
    }

    void resume() {
        const fs::path from =
            fs::is_directory(common_.resume) ? common_.resume / checkpoint_name : common_.resume;
        const Archive state =
            checkpoint_to_resume(from, common_.scenario, common_.settings, may_differ_).state;
        double settled = 0;
        get_fields(state, "track/numbers", std::tie(done_, fastest_, settled));
        require(done_ <= track_.cycles,
                fmt::format("--cycles: expected at least the {} of the checkpoint, found {}", done_,
                            track_.cycles));
        history_ = get_history(state, track_.stretch.ties);
        for_bays([&](std::size_t k) {
            bays_[k]->resume(bay_file(from.parent_path() / folders_[k].filename(), done_));
        });
        stretch_.settle(state.get<double>("track/levels"), settled);
        take_stiffness();
        if (fs::equivalent(from.parent_path(), common_.out)) saved_ = done_;
    }

    CoupledTrack track_;
    const Common& common_;
    std::vector<std::string_view> may_differ_;
    TrackStretch stretch_;
    std::vector<double> rates_;
    Progress progress_;
    std::vector<std::size_t> ties_;                  ///< with a bay
    std::vector<std::unique_ptr<BedBelowTie>> bays_; ///< of these
    std::vector<fs::path> folders_;                  ///< of these
    unsigned done_ = 0, saved_ = 0; ///< axles; saved_: of the last state of this run
    double fastest_ = 0;            ///< m for an axle, in the last block
    CoupledHistory history_;
};

} // namespace

bool CoupledTrack::has_bay(std::size_t tie) const { return stretch.is_in_middle(tie, bays); }

void check_coupled(const CoupledTrack& track) {
    const StretchSettings& s = track.stretch;
    require(track.bays >= 1 && track.bays <= s.ties && (s.ties - track.bays) % 2 == 0,
            fmt::format("--bays: expected at most the {} of --ties, and as odd or even, found {}",
                        s.ties, track.bays));
    require(s.mud_ties < track.bays,
            fmt::format("--bays: expected more than the {} of --mud-ties, found {}", s.mud_ties,
                        track.bays));
    for (const BallastBox* box : {&track.clean, &track.mud}) check_box(*box);
    require(!box_test(track.clean.run).fouled && box_test(track.mud.run).fouled,
            fmt::format("--mud-run: expected a fouled run, II.1 to II.4, found {}", track.mud.run));
}

CoupledHistory couple_bays(const CoupledTrack& track, const Common& common,
                           const std::vector<std::string_view>& may_differ) {
    const auto bay_of = [&track](std::size_t tie, const Common& own) {
        const BallastBox& box = track.stretch.is_mud(tie) ? track.mud : track.clean;
        return std::make_unique<Bay>(box, of_box(box, own));
    };
    return couple_beds(track, bay_of, common, may_differ);
}

CoupledHistory couple_beds(const CoupledTrack& track, const MakeBed& bed_of, const Common& common,
                           const std::vector<std::string_view>& may_differ) {
    const std::string hint = fmt::format("continue with --resume {}", common.out.string());
    const SavesWhenInterrupted saves(hint);
    try {
        return Coupling(track, bed_of, common, may_differ).run();
    } catch (const Interrupted&) {
        const bool saved = fs::exists(common.out / checkpoint_name);
        throw Interrupted(saved ? "interrupted; " + hint : "interrupted before the first block");
    }
}

double ratio_of_bays(const CoupledTrack& track, const CoupledHistory& history) {
    std::array<double, 2> settled{}, expected{}; // good, mud
    std::vector<double> before(track.stretch.ties, 0), cycles(track.stretch.ties, 0);
    for (const BayBlock& b : history.blocks) {
        const std::size_t mud = track.stretch.is_mud(b.tie) ? 1 : 0;
        settled[mud] += b.settlement - before[b.tie];
        expected[mud] += (b.cycles - cycles[b.tie]) * std::pow(b.load, track.law.exponent);
        before[b.tie] = b.settlement;
        cycles[b.tie] = b.cycles;
    }
    return settled[1] / expected[1] / (settled[0] / expected[0]);
}

} // namespace bris
