#pragma once

#include <string>
#include <string_view>

#include <busbar/net/system.hpp>

namespace busbar::tool {

/// Prints the library's log on standard error if requested. Keeps the reason why there is no
/// connection for a Failure, since a StatusCode says little about it.
class VerboseLog final : public LogSink {
public:
    explicit VerboseLog(bool is_verbose) : is_verbose_{is_verbose} {}

    void write(LogLevel level, std::string_view source, std::string_view text) override
    {
        constexpr std::string_view no_connection = "cannot connect to ";
        if (source == "net" && text.starts_with(no_connection)) {
            why_unconnected_ = text.substr(text.rfind(": ") + 2);
        }
        if (is_verbose_) {
            log_.write(level, source, text);
        }
    }

    /// "Connection refused"; empty if no attempt has failed.
    [[nodiscard]] const std::string& why_unconnected() const { return why_unconnected_; }

private:
    bool is_verbose_;
    std::string why_unconnected_;
    net::StderrLog log_{LogLevel::Debug};
};

} // namespace busbar::tool
