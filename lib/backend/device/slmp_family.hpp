#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <string_view>

#include <busbar/backend/device_protocols.hpp>

namespace busbar::backend::detail {

/// The results of asking a PLC, which outlive a connection; the next one may be to another PLC.
struct SlmpFindings {
    /// The frame that the next connection begins with.
    SlmpFrame frame{SlmpFrame::Frame4E};
    /// The other frame is tried where this one has no answer.
    bool may_change{true};
    /// The form of requests.
    bool has_long_form{true};
    /// The family as configured, and as it is.
    SlmpFamily configured{SlmpFamily::IqR};
    SlmpFamily family{SlmpFamily::IqR};
    /// Commands that the PLC has, as far as is known: random and block read and write.
    bool has_random_read{true};
    bool has_random_write{true};
    bool has_block_read{true};
    bool has_block_write{true};
    /// X or Y are used.
    bool has_io{false};
    /// The name of the type that the rest was found out of.
    std::string name{};
    /// Counts changes of what is found.
    std::uint64_t version{0};

    /// Takes the answer to the question for the type's name: what is known of another PLC is
    /// forgotten. Returns why the PLC cannot be used; empty if it can.
    [[nodiscard]] std::string learn(std::string_view type_name, std::uint16_t end_code);
    /// Says whether the PLC has the long form.
    void set_long_form(bool has_it);
    /// The PLC does not have this command. False if that was known.
    bool lose(SlmpCommand command);
};

/// Limits of requests by form and family (SH-080956ENG, 0401 to 1406; measured where marked).
struct SlmpLimits {
    std::uint32_t bits{7'168};
    /// Words of a random read, of the own station and of modules; 0 without the command.
    std::uint32_t random_read{0};
    std::uint32_t random_read_extended{0};
    /// Words and bits of a random write.
    std::uint32_t random_write{0};
    std::uint32_t random_write_bits{0};
    /// Blocks of a block read and write; 1 without the command.
    std::uint32_t read_blocks{1};
    std::uint32_t write_blocks{1};
    std::size_t under_way{SIZE_MAX};
};
[[nodiscard]] SlmpLimits limits_of(const SlmpFindings& findings, bool is_datagram);

/// Returns what is known at first.
[[nodiscard]] SlmpFindings findings_of(const SlmpProtocolOptions& options);

} // namespace busbar::backend::detail
