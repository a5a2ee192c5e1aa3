#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>

#include <busbar/core/text.hpp>
#include <busbar/core/text_forms.hpp>
#include <busbar/harness/fault.hpp>

#include "acting_faults.hpp"

namespace busbar::harness {

namespace {

/// "1.5 s".
std::string time_text(Duration time)
{
    std::array<char, 32> text{};
    const double seconds = std::chrono::duration<double>{time}.count();
    const auto end = std::to_chars(text.data(), text.data() + text.size(), seconds).ptr;
    return std::string{text.data(), end} + " s";
}

std::string_view side_name(Side side)
{
    return side == Side::Client ? "client" : "server";
}

std::string moment_text(const Fault& fault)
{
    static constexpr std::array<std::string_view, 3> moments{" before ", " at ", " after "};
    if (fault.message) {
        return std::string{moments.at(static_cast<std::size_t>(fault.moment))} +
               fault.message->name + " " + std::to_string(fault.message->number);
    }
    if (fault.byte_offset) {
        return " at byte " + std::to_string(*fault.byte_offset);
    }
    return fault.time ? " after " + time_text(*fault.time) : "";
}

std::string kind_text(const Fault& fault)
{
    switch (fault.kind) {
    case Fault::Kind::Delay:
        return "delay " + time_text(fault.duration);
    case Fault::Kind::Hold:
        return fault.duration == Duration{0} ? "hold" : "hold " + time_text(fault.duration);
    case Fault::Kind::Cut:
        return "cut";
    case Fault::Kind::HalfOpen:
        return "half open";
    case Fault::Kind::Corrupt:
        return "corrupt " + std::to_string(fault.position) + " bit " + std::to_string(fault.bit);
    case Fault::Kind::Split:
        return "split " + std::to_string(fault.position);
    case Fault::Kind::Answer:
        return "answer " + std::string{name(fault.status)};
    case Fault::Kind::JumpClock:
        return "jump clock " + time_text(fault.duration);
    case Fault::Kind::Refuse:
        return "refuse";
    case Fault::Kind::Drop:
        return "drop";
    case Fault::Kind::Duplicate:
        return "duplicate";
    case Fault::Kind::Overtake:
        return "overtake";
    case Fault::Kind::Change:
        return fault.edit_text;
    }
    return {};
}

/// Reads the words of a fault's text.
class FaultReader {
public:
    explicit FaultReader(std::string_view text) : rest_{text} {}

    [[nodiscard]] Configured<Fault> read()
    {
        Fault fault = read_kind();
        while (flaw_.empty() && !peek().empty()) {
            fault = read_more(fault);
        }
        if (flaw_.empty()) {
            flaw_ = detail::flaw_of(fault);
        }
        if (!flaw_.empty()) {
            return misconfigured({}, flaw_);
        }
        return fault;
    }

private:
    [[nodiscard]] Fault read_kind();
    [[nodiscard]] Fault read_more(const Fault& fault);
    [[nodiscard]] Fault read_edit();
    [[nodiscard]] Fault read_corrupt();

    /// The next word; empty at the end.
    [[nodiscard]] std::string_view peek()
    {
        rest_.remove_prefix(std::min(rest_.find_first_not_of(' '), rest_.size()));
        return rest_.substr(0, rest_.find(' '));
    }
    std::string_view take()
    {
        const std::string_view word = peek();
        rest_.remove_prefix(word.size());
        return word;
    }
    [[nodiscard]] bool accept(std::string_view word)
    {
        if (peek() != word) {
            return false;
        }
        take();
        return true;
    }
    void expected(std::string_view what)
    {
        const std::string_view word = peek();
        if (flaw_.empty()) {
            flaw_ = "found " +
                    (word.empty() ? std::string{"the end"} : "\"" + printable(word) + "\"") +
                    "; expected " + std::string{what};
        }
    }
    [[nodiscard]] std::optional<std::size_t> number_if()
    {
        const std::string_view word = peek();
        std::size_t number = 0;
        const auto end = std::from_chars(word.data(), word.data() + word.size(), number);
        if (word.empty() || end.ec != std::errc{} || end.ptr != word.data() + word.size()) {
            return std::nullopt;
        }
        take();
        return number;
    }
    std::size_t number(std::string_view what)
    {
        if (const auto found = number_if()) {
            return *found;
        }
        expected(what);
        return 0;
    }
    /// "2s" or "2 s"; nothing if it is none.
    [[nodiscard]] std::optional<Duration> time_if();
    Duration time()
    {
        if (const auto found = time_if()) {
            return *found;
        }
        expected("a time with its unit, as 200ms, 2s, 5min or 1h");
        return {};
    }

    std::string_view rest_;
    std::string flaw_;
};

std::optional<Duration> FaultReader::time_if()
{
    const std::string_view before = rest_;
    const std::string_view word = peek();
    double number = 0;
    const auto end = std::from_chars(word.data(), word.data() + word.size(), number);
    if (word.empty() || end.ec != std::errc{} || !std::isfinite(number)) {
        return std::nullopt;
    }
    take();
    std::string_view unit = word.substr(static_cast<std::size_t>(end.ptr - word.data()));
    if (unit.empty()) {
        unit = take();
    }
    struct Unit {
        std::string_view name;
        double seconds;
    };
    static constexpr std::array units{Unit{"ms", 0.001}, Unit{"s", 1}, Unit{"min", 60},
                                      Unit{"h", 3'600}};
    constexpr double most = 1e6; // seconds, eleven days
    for (const Unit& known : units) {
        if (unit == known.name && std::abs(number * known.seconds) <= most) {
            return std::chrono::round<Duration>(
                std::chrono::duration<double>{number * known.seconds});
        }
    }
    rest_ = before;
    return std::nullopt;
}

Fault FaultReader::read_corrupt()
{
    const std::size_t position = number("the number of a byte in the message");
    const std::size_t bit = accept("bit") ? number("the number of a bit") : 0;
    if (bit > 7 && flaw_.empty()) {
        flaw_ = "found bit " + std::to_string(bit) + "; expected 0 to 7";
    }
    return fault::corrupt(position, static_cast<unsigned>(bit % 8));
}

/// edit results[0].value = Double:1.5 at ReadResponse: the value ends before the moment.
Fault FaultReader::read_edit()
{
    const std::string path{take()};
    if (path.empty() || !accept("=")) {
        expected("\"edit FIELD = VALUE at MESSAGE\"");
        return {};
    }
    static_cast<void>(peek());
    const std::size_t at = rest_.rfind(" at ");
    const std::size_t before = rest_.rfind(" before ");
    const std::size_t end = at == std::string_view::npos       ? before
                            : before == std::string_view::npos ? at
                                                               : std::max(at, before);
    if (end == std::string_view::npos) {
        expected("the value, and \"at\" with the name of a message");
        return {};
    }
    const std::string value{rest_.substr(0, end)};
    rest_.remove_prefix(end);
    return fault::edit(path, value);
}

Fault FaultReader::read_kind()
{
    const std::string_view begin = rest_;
    const std::string_view word = take();
    if (word == "cut") {
        return fault::cut();
    }
    if (word == "delay") {
        return fault::delay(time());
    }
    if (word == "hold") {
        return fault::hold(time_if().value_or(Duration{0}));
    }
    if (word == "half" && accept("open")) {
        return fault::half_open();
    }
    if (word == "corrupt") {
        return read_corrupt();
    }
    if (word == "split") {
        return fault::split(number_if().value_or(1));
    }
    if (word == "answer") {
        if (const auto status = parse_status_code(peek())) {
            take();
            return fault::answer(*status);
        }
        expected("the name of a status, as Bad_Timeout");
        return {};
    }
    if (word == "jump" && accept("clock")) {
        return fault::jump_clock(time());
    }
    if (word == "refuse") {
        return fault::refuse();
    }
    if (word == "drop") {
        return fault::drop();
    }
    if (word == "duplicate") {
        return fault::duplicate();
    }
    if (word == "overtake") {
        return fault::overtake();
    }
    if (word == "edit") {
        return read_edit();
    }
    if (word == "truncate") {
        return fault::truncate(number("the number of bytes that are missing"));
    }
    rest_ = begin;
    expected("cut, delay, hold, half open, corrupt, split, answer, jump clock, refuse, drop, "
             "duplicate, overtake, edit or truncate");
    return {};
}

Fault FaultReader::read_more(const Fault& fault)
{
    const auto message = [&] {
        Message found{std::string{take()}, 1};
        found.number = number_if().value_or(1);
        return found;
    };
    const bool has_moment = fault.message || fault.byte_offset || fault.time;
    if (has_moment && (peek() == "before" || peek() == "at" || peek() == "after")) {
        expected("one moment only");
        return fault;
    }
    if (accept("before")) {
        return fault.before(message());
    }
    if (accept("at")) {
        return accept("byte") ? fault.at_byte(number("the number of a byte")) : fault.at(message());
    }
    if (accept("after")) {
        const auto delay = time_if();
        return delay ? fault.after(*delay) : fault.after(message());
    }
    if (accept("of")) {
        static_cast<void>(accept("the"));
        const bool is_client = accept("client");
        if (!is_client && !accept("server")) {
            expected("client or server");
        }
        return fault.sent_by(is_client ? Side::Client : Side::Server);
    }
    if (accept("on")) {
        static_cast<void>(accept("connection"));
        const std::size_t which = number("the number of a connection, from 1");
        if (which == 0 && flaw_.empty()) {
            flaw_ = "connections are counted from 1";
        }
        return fault.on_connection(which);
    }
    if (accept("times")) {
        const std::size_t times = number("how often it acts");
        if (times == 0 && flaw_.empty()) {
            flaw_ = "it acts 0 times; \"always\" is without a limit";
        }
        return fault.times(times);
    }
    if (accept("always")) {
        return fault.times(0);
    }
    expected("before, at, after, of, on, times or always");
    return fault;
}

} // namespace

std::string describe(const Fault& fault)
{
    std::string text = kind_text(fault) + moment_text(fault);
    if (fault.side) {
        text += " of the " + std::string{side_name(*fault.side)};
    }
    if (fault.connection != 0) {
        text += " on connection " + std::to_string(fault.connection);
    }
    if (fault.count != 1) {
        text += fault.count == 0 ? " always" : " times " + std::to_string(fault.count);
    }
    return text;
}

Configured<Fault> parse_fault(std::string_view text)
{
    const bool has_controls = std::any_of(text.begin(), text.end(), [](char c) {
        return static_cast<unsigned char>(c) < 0x20 || c == 0x7F;
    });
    if (has_controls) {
        return misconfigured({}, "found a control character; expected one line of text");
    }
    return FaultReader{text}.read();
}

Configured<FaultScript> read_faults(std::string_view text, std::string_view file_name)
{
    constexpr std::size_t max_faults = 1'000;
    FaultScript script;
    std::size_t number = 0;
    while (!text.empty()) {
        const std::size_t end = text.find('\n');
        std::string_view line = text.substr(0, end);
        text.remove_prefix(end == std::string_view::npos ? text.size() : end + 1);
        ++number;
        while (!line.empty() && (line.back() == ' ' || line.back() == '\r')) {
            line.remove_suffix(1);
        }
        const std::size_t begin = line.find_first_not_of(' ');
        if (begin == std::string_view::npos || line[begin] == '#') {
            continue;
        }
        const std::string where = std::string{file_name} + ":" + std::to_string(number);
        auto fault = parse_fault(line);
        if (!fault) {
            return misconfigured(where, fault.error().text);
        }
        if (script.size() == max_faults) {
            return misconfigured(where,
                                 "there are more than " + std::to_string(max_faults) + " faults");
        }
        script.push_back(*std::move(fault));
    }
    return script;
}

} // namespace busbar::harness
