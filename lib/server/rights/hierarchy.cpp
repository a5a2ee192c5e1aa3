#include "hierarchy.hpp"

#include <unordered_set>
#include <vector>

namespace busbar::server::detail {

bool is_below(const model::AddressSpace& space, model::NodeIndex node, model::NodeIndex top,
              model::NodeIndex type, std::size_t& visits_left)
{
    std::vector<model::NodeIndex> above{node};
    std::unordered_set<model::NodeIndex> seen{node};
    for (std::size_t i = 0; i < above.size(); ++i) {
        if (above[i] == top) {
            return true;
        }
        model::ReferenceCursor cursor = space.references(above[i]);
        while (const auto reference = cursor.next()) {
            if (visits_left == 0) {
                return false;
            }
            --visits_left;
            if (!reference->is_forward && space.is_subtype_of(reference->type, type) &&
                seen.insert(reference->target).second) {
                above.push_back(reference->target);
            }
        }
    }
    return false;
}

} // namespace busbar::server::detail
