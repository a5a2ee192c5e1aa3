#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include <busbar/controller/mapped_source.hpp>
#include <busbar/core/problem.hpp>

namespace busbar::bench {

/// The load that the manual of model mode measures (SH-082679, Appendix 7), and its figures beside
/// ours.
///
/// Client, server and PLC are threads of this process. Reads, Writes and Subscriptions are wall
/// time, as a client sees it over loopback TCP, Basic256Sha256 and SignAndEncrypt; start-up is
/// processor time, from the text of a project's file until the labels are there, without what the
/// PLC takes.
///
/// The floor is what the same costs without model mode. Of Reads, Writes and Subscriptions: the
/// same request over the same channel for as many plain Int16 of a process image, which the same
/// PLC publishes with each scan. Of start-up: a server that loads the same files and maps nothing.
struct SevenOptions {
    /// Of "reads", "writes", "subscriptions" and "startup"; none: all of them.
    std::vector<std::string> only;
    /// Of "standard", "items" and "all"; none: all of them.
    std::vector<std::string> modes;
    /// Measurements of each figure; of start-up three at most, as in the manual.
    int rounds{100};
    /// Rows of more Variables are left out, and the server of the others has no more either.
    std::size_t most{25'000};
};

struct SevenRow {
    std::string load; // "read", "write", "subscription" or "startup"
    controller::SamplingMode mode{controller::SamplingMode::Standard};
    /// Of one request or subscription; of start-up those of the model.
    std::size_t variables{0};
    std::size_t objects{0};
    std::size_t files{1};
    bool is_mapped{true};
    int rounds{0};
    /// None: the manual has no figure of this.
    std::optional<double> manual_ms;
    /// Means, of a subscription the mean of the intervals between its notifications.
    double measured_ms{0};
    double floor_ms{0};
};

/// "standard", "items" or "all": as SevenOptions::modes.
[[nodiscard]] std::string_view mode_name(controller::SamplingMode mode);

/// The rows of the options, in the manual's order. A problem says which of them failed: also when
/// a subscription lost a message, or a value of it went back.
[[nodiscard]] Configured<std::vector<SevenRow>> measure_appendix7(const SevenOptions& options);

/// Prints a table for people, or one JSON object.
void print(const std::vector<SevenRow>& rows, bool json);

} // namespace busbar::bench
