#include "engine/signal/attitude.hpp"

namespace bris {

// not in the header: for opposite vectors it contains a singular value decomposition, which takes
// seconds to compile
Quat shortest_rotation(const Vec3& from, const Vec3& to) { return Quat::FromTwoVectors(from, to); }

} // namespace bris
