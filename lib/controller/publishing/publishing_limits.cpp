#include <busbar/controller/publishing_limits.hpp>

namespace busbar::controller {

PublishingLimits nj501_publishing()
{
    PublishingLimits limits;
    limits.max_variables = 10'000;
    limits.max_values = 10'000;
    limits.max_data_types = 100;
    limits.max_size = 1'024;
    limits.max_elements = 1'024;
    limits.max_members = 100;
    limits.max_levels = 3;
    limits.allows_any_first_index = false;
    limits.allows_matrices_with_structures = false;
    limits.allows_unions = false;
    return limits;
}

PublishingLimits nx102_publishing()
{
    return nj501_publishing();
}

} // namespace busbar::controller
