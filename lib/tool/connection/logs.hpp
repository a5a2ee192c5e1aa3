#pragma once

#include <memory>
#include <string>
#include <string_view>

#include <busbar/channel/key_log.hpp>
#include <busbar/core/log.hpp>
#include <busbar/core/text.hpp>
#include <busbar/net/system.hpp>

#include "context.hpp"

namespace busbar::tool {

/// Prints the library's log on standard error if requested. Keeps for a Failure the reason why
/// there is no connection and what this side refused, since a StatusCode says little about it, and
/// not who sent it.
class VerboseLog final : public LogSink {
public:
    explicit VerboseLog(bool is_verbose) : is_verbose_{is_verbose} {}

    void write(LogLevel level, std::string_view source, std::string_view text) override
    {
        constexpr std::string_view no_connection = "cannot connect to ";
        if (source == "net" && text.starts_with(no_connection)) {
            why_unconnected_ = text.substr(text.rfind(": ") + 2);
        }
        // The form of explain(): the check, the finding, the status, the rule, the remedy.
        if (level == LogLevel::Warning && (source == "channel" || source == "client") &&
            text.find(" failed: ") != std::string_view::npos) {
            refusal_ = text;
        }
        if (is_verbose_) {
            log_.write(level, source, text);
        }
    }

    /// "Connection refused"; empty if no attempt has failed.
    [[nodiscard]] const std::string& why_unconnected() const { return why_unconnected_; }
    /// Returns what this side did not accept of the server, if it ended the connection with this
    /// status; empty if the server, or the network, ended it.
    [[nodiscard]] std::string refusal_with(StatusCode status) const
    {
        const std::size_t end = refusal_.rfind(": " + std::string{name(status)} + ", ");
        return status.is_bad() && end != std::string::npos ? refusal_.substr(0, end)
                                                           : std::string{};
    }

private:
    bool is_verbose_;
    std::string why_unconnected_;
    std::string refusal_;
    net::StderrLog log_{LogLevel::Debug};
};

/// Returns the file of --key-log, which only its owner can read, after a warning; null if the
/// option is not given. Throws Failure, also in a build that does not export keys. `log` must
/// outlive the result.
[[nodiscard]] std::unique_ptr<channel::KeyLog> open_key_log(Context& context, LogSink& log);

} // namespace busbar::tool
