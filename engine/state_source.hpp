#pragma once

#include "engine/archive.hpp"

#include <functional>
#include <vector>

namespace bris {

/// State that passes piece by piece, so that nobody needs memory for all of it.
class StateSource {
public:
    using Visit = std::function<void(const StatePiece&)>;
    virtual ~StateSource() = default;
    /// Calls visit, which may be empty, for all pieces, in the order of for_pieces. Of a world
    /// that is divided among ranks, all ranks must call this, and the pieces come to the first one.
    virtual void for_pieces(const Visit& visit) const = 0;
};

/// What is left of State when its pieces have passed: arrays without rows, and hashes.
class StateHashes {
public:
    void add(const StatePiece& piece);
    const Archive& arrays() const { return arrays_; }
    const std::vector<StateBlock>& blocks() const { return hashes_.blocks(); }
    std::uint64_t fingerprint() const { return bris::fingerprint(arrays_, blocks()); }

private:
    Archive arrays_;
    BlockHashes hashes_;
};

/// The fingerprint of State: on all ranks that of what comes to this one.
std::uint64_t fingerprint(const StateSource& state);

} // namespace bris
