#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <string_view>

#include "load.hpp"

namespace busbar::bench {

/// A client of a MappedPlant.
class SevenClient {
public:
    [[nodiscard]] Result<void> open(const std::string& url);
    /// The mean of so many of a "read", "write" or "subscription" of the first `count` Variables,
    /// whose NodeIds begin with `prefix`. The status of a result that is not good; of a
    /// subscription Bad_SequenceNumberInvalid if a message was lost, Bad_DataLost if a value of it
    /// went back or came twice.
    [[nodiscard]] Result<double> measure_ms(std::string_view load, std::string_view prefix,
                                            std::size_t count, int rounds);

private:
    std::optional<Load> load_; // outlives the loop's connection
    net::ClientLoop loop_;
};

} // namespace busbar::bench
