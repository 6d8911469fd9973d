#pragma once

#include "engine/archive.hpp"
#include "engine/world.hpp"

#include <vector>

namespace bris {

/// What a tie of a track has done in a passage: m, downwards, from its height at the beginning, and
/// N, of the part of the tie that is modelled. `now`, which at the end is the settlement, and
/// `support_now`: at present; the others: the largest so far.
struct TieRecord {
    double height = 0; ///< m, at the beginning
    double now = 0, support_now = 0, deflection = 0, load = 0, support = 0;
};

/// Records of all ties of a track in the present passage, in their order along it, and the largest
/// numbers of each passage; kept in checkpoints.
class TieRecords {
public:
    /// Before the first step of each passage.
    void begin(const World& observed);
    /// At a time at which all that touches is known: of a divided world on all ranks.
    void note(const World& observed);

    double began() const { return began_; } ///< s, of the first passage
    const std::vector<TieRecord>& all() const { return ties_; }
    const TieRecord& middle() const { return ties_[ties_.size() / 2]; }
    /// The largest of each number, of all ties, in each passage, the present one last.
    const std::vector<TieRecord>& passages() const { return passages_; }

    void save(Archive& archive) const;
    void load(const Archive& archive);

private:
    double began_ = 0;
    std::vector<TieRecord> ties_, passages_;
};

} // namespace bris
