#pragma once

#include <algorithm>
#include <cstddef>
#include <optional>
#include <vector>

#include <busbar/core/status_code.hpp>

namespace busbar::client::detail {

/// Assigns items to requests.
class BatchPlan {
public:
    struct Part {
        std::size_t first{0};
        std::size_t count{0};
    };

    BatchPlan(std::size_t items, std::size_t max_items);

    /// Limits the size of parts from now on; 0 means no limit.
    void limit(std::size_t max_items);
    /// Returns the next part, nothing if there is none.
    [[nodiscard]] std::optional<Part> next();
    /// The part was too large: it comes again in halves, and later ones are no larger. False if it
    /// is one item, which cannot be halved.
    [[nodiscard]] bool halve(Part part);
    /// Returns all remaining parts, to be given up.
    [[nodiscard]] std::vector<Part> take_rest();

private:
    std::vector<Part> waiting_; // the next one is at the end
    std::size_t max_items_;
};

/// True if a request with fewer items may succeed. A service that must not be executed twice is
/// repeated only if the server cannot have begun it.
[[nodiscard]] bool is_too_large(StatusCode why, bool is_repeatable);

} // namespace busbar::client::detail
