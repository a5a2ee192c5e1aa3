#pragma once

#include <algorithm>
#include <cstddef>
#include <optional>
#include <vector>

#include <busbar/core/status_code.hpp>

namespace busbar::client::detail {

/// Which items go into which request.
class BatchPlan {
public:
    struct Part {
        std::size_t first{0};
        std::size_t count{0};
    };

    BatchPlan(std::size_t items, std::size_t max_items);

    /// Parts from now on are no larger; 0 is no limit.
    void limit(std::size_t max_items);
    /// The next part, nothing if there is no more.
    [[nodiscard]] std::optional<Part> next();
    /// The part was too large: it comes again in halves, and others are no larger. False if it is
    /// one item, which cannot be halved.
    [[nodiscard]] bool halve(Part part);
    /// All that is left, to be given up.
    [[nodiscard]] std::vector<Part> take_rest();

private:
    std::vector<Part> waiting_; // the next one last
    std::size_t max_items_;
};

/// True if a request with fewer items may succeed. A service that must not be carried out twice
/// is repeated only where the server cannot have begun with it.
[[nodiscard]] bool is_too_large(StatusCode why, bool is_repeatable);

} // namespace busbar::client::detail
