#include <busbar/core/refusal.hpp>

#include <busbar/core/text.hpp>

namespace busbar {

namespace {

std::string finding_of(const Refusal& refusal)
{
    std::string text = refusal.found.empty() ? std::string{} : ": " + refusal.found;
    if (!refusal.thumbprint.empty()) {
        text += " (" + refusal.subject + ", " + refusal.thumbprint + ")";
    }
    return text;
}

} // namespace

std::string text(const Refusal& refusal)
{
    std::string line{refusal.check};
    line += " failed" + finding_of(refusal) + ": ";
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

std::string reason_of(const Refusal& refusal)
{
    std::string text = std::string{refusal.check} + finding_of(refusal);
    return refusal.remedy.empty() ? text : text + ". " + refusal.remedy;
}

void explain(LogSink& log, std::string_view source, const Refusal& refusal)
{
    log.write(LogLevel::Warning, source, text(refusal));
}

} // namespace busbar
