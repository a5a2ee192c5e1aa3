#pragma once

#include <algorithm>
#include <cstddef>
#include <string>
#include <vector>

#include <busbar/core/result.hpp>

#include "process.hpp"

namespace busbar::bench {

/// What happens to a controller all at once: clients come, subscribe, read, write and leave;
/// administrators call what they may; programs are downloaded; people use `busbar admin`.
struct ChurnOptions {
    /// The busbar-controller that it happens to; empty: the code of this program.
    std::string controller;
    /// The `busbar` that administrators use; empty: they do not.
    std::string tool;
    double seconds{10};
    /// Clients at a time, beside those of administration.
    std::size_t clients{6};
    /// Between two downloads, at most, each of which ends all connections.
    std::size_t pause_s{3};
    unsigned seed{1};
    /// Instead of all that: so many Calls of administration with changed bytes; see send_mutated().
    std::size_t mutated{0};
};

/// One kind of thing that was done, and how often it went well.
struct ChurnRow {
    std::string what;
    std::size_t good{0};
    std::size_t refused{0};
};

struct ChurnReport {
    std::vector<ChurnRow> rows;
    /// What happened depended on it.
    unsigned seed{1};
    /// Of the controller, soon after its start and at the end.
    Memory before;
    Memory after;
    /// A client that came when all was over was served.
    bool serves{false};
    /// Of the controller when it was told to end.
    int exit_code{0};
    /// The first line of its output with which a sanitizer complains; empty: none does.
    std::string complaint;
    /// With that output; is kept unless all is well.
    std::string folder;
    /// The rows of things that must have gone well at least once: where nobody was let in, nothing
    /// was tried.
    std::vector<std::string> needed;

    /// The first of those that never went well; empty: all did.
    [[nodiscard]] std::string never_done() const
    {
        for (const std::string& what : needed) {
            const bool was_done = std::any_of(rows.begin(), rows.end(), [&](const ChurnRow& row) {
                return row.what == what && row.good != 0;
            });
            if (!was_done) {
                return what;
            }
        }
        return {};
    }
    [[nodiscard]] bool is_well() const
    {
        return serves && exit_code == 0 && complaint.empty() && never_done().empty();
    }
};

/// Starts a controller and does all that for the time of the options.
[[nodiscard]] Result<ChurnReport> churn(const ChurnOptions& options);

} // namespace busbar::bench
