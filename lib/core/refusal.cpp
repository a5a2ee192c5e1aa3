#include <busbar/core/refusal.hpp>

#include <busbar/core/text.hpp>

namespace busbar {

std::string text(const Refusal& refusal)
{
    std::string line{refusal.check};
    line += " failed";
    if (!refusal.found.empty()) {
        line += ": " + refusal.found;
    }
    if (!refusal.thumbprint.empty()) {
        line += " (" + refusal.subject + ", " + refusal.thumbprint + ")";
    }
    line += ": ";
    line += name(refusal.status);
    if (!refusal.rule.empty()) {
        line += ", ";
        line += refusal.rule;
    }
    line += ".";
    if (!refusal.remedy.empty()) {
        line += " " + refusal.remedy + ".";
    }
    return line;
}

void explain(LogSink& log, std::string_view source, const Refusal& refusal)
{
    log.write(LogLevel::Warning, source, text(refusal));
}

} // namespace busbar
