#include "backend_config.hpp"

#include <algorithm>
#include <array>
#include <cctype>
#include <charconv>
#include <cmath>
#include <fstream>
#include <set>
#include <string_view>
#include <utility>

#include <busbar/model/units.hpp>

#include "controller/mapping/table_fields.hpp"
#include "product/configuration/toml_reader.hpp"

namespace busbar::product {

namespace {

using backend::DevicePoint;
using backend::DeviceScale;
using backend::ModbusProtocolOptions;
using backend::SlmpProtocolOptions;
using std::chrono::milliseconds;

constexpr std::size_t most_backends = 64;
constexpr std::size_t most_table_size = 64U << 20U;
constexpr std::size_t most_field = 1'024;
constexpr std::size_t longest_name = 128;
constexpr std::array<std::string_view, 4> scale_keys{"raw_low", "raw_high", "low", "high"};

/// A mistake of a variable in the configuration or a table: the key and the reason.
struct Mistake {
    std::string_view key;
    std::string text;
};
template <typename T>
using Valid = Expected<T, Mistake>;

/// A variable as it is written.
struct Written {
    std::string name;
    std::string at;
    std::string access;
    /// In the order of scale_keys.
    std::array<std::optional<double>, 4> scale;
    std::string unit;
    std::string description;
};

Valid<std::optional<DeviceScale>> scale_of(const Written& from, const DevicePoint& point)
{
    const auto given = static_cast<std::size_t>(
        std::count_if(from.scale.begin(), from.scale.end(), [](const auto& each) { return each; }));
    if (given == 0) {
        return std::nullopt;
    }
    if (given != from.scale.size()) {
        return Unexpected{Mistake{"raw_low", "found some of raw_low, raw_high, low and high, "
                                             "expected all four or none"}};
    }
    const DeviceScale scale{*from.scale[0], *from.scale[1], *from.scale[2], *from.scale[3]};
    const bool is_finite = std::isfinite(scale.raw_low) && std::isfinite(scale.raw_high) &&
                           std::isfinite(scale.low) && std::isfinite(scale.high);
    if (!is_finite || scale.raw_low == scale.raw_high || scale.low >= scale.high) {
        return Unexpected{Mistake{"raw_low", "found no line through two points, expected two "
                                             "different raw values, and low below high"}};
    }
    const BuiltInType type = backend::data_type_of(point);
    if (type == BuiltInType::Boolean || type == BuiltInType::String) {
        return Unexpected{Mistake{"raw_low", "found a scale of a " + std::string{name(type)} +
                                                 ", expected one of a number only"}};
    }
    return scale;
}

Valid<BackendVariable> check(Written from, const BackendConfig& config)
{
    const bool is_name = !from.name.empty() && from.name.size() <= longest_name &&
                         std::ranges::all_of(from.name, [](char each) {
                             const auto byte = static_cast<unsigned char>(each);
                             return byte > 0x20 && byte < 0x7F && each != '/' && each != '"';
                         });
    if (!is_name) {
        return Unexpected{Mistake{"name", "found \"" + from.name +
                                              "\", expected 1 to 128 characters of ASCII without "
                                              "blanks, / and \""}};
    }
    auto point = config.protocol.index() == 0
                     ? backend::parse_modbus_point(from.at, std::get<0>(config.protocol))
                     : backend::parse_slmp_point(from.at, std::get<1>(config.protocol));
    if (!point) {
        const Problem& problem = point.error();
        return Unexpected{
            Mistake{"at", "\"" + from.at + "\", " + problem.where + ": " + problem.text}};
    }
    if (!from.access.empty() && from.access != "read" && from.access != "write") {
        return Unexpected{
            Mistake{"access", "found \"" + from.access + "\", expected \"read\" or \"write\""}};
    }
    if (from.access == "write" && !point->is_writable) {
        return Unexpected{Mistake{"access", "found \"write\", expected \"read\" for " + from.at +
                                                ", which the protocol cannot write"}};
    }
    point->is_writable = from.access == "write";
    if (!from.unit.empty() && model::unit_id(from.unit) == -1) {
        return Unexpected{
            Mistake{"unit", "found \"" + from.unit +
                                "\", expected a code of UNECE Recommendation 20, such "
                                "as CEL for degrees Celsius"}};
    }
    auto scale = scale_of(from, *point);
    if (!scale) {
        return Unexpected{std::move(scale).error()};
    }
    point->scale = *scale;
    return BackendVariable{std::move(from.name), std::move(from.at), *point, std::move(from.unit),
                           std::move(from.description)};
}

Written read_variable(const TomlTable& table)
{
    table.allow(
        {"name", "at", "access", "raw_low", "raw_high", "low", "high", "unit", "description"});
    Written written{table.text("name"),           table.text("at"),
                    table.text("access", "read"), {},
                    table.text("unit", ""),       table.text("description", "")};
    for (std::size_t i = 0; i < scale_keys.size(); ++i) {
        if (table.has(scale_keys[i])) {
            written.scale[i] = table.number(scale_keys[i], 0);
        }
    }
    return written;
}

/// A table of variables, which several backends may name.
class VariableTable {
public:
    VariableTable(std::string file, std::string_view text)
        : file_{std::move(file)}, fields_{text, most_field}
    {
        if (!read()) {
            refuse("found no line, expected the names of the columns: name, at");
        }
        columns_ = now_;
        for (const std::string& column : columns_) {
            const bool is_known = std::ranges::find(known, column) != known.end();
            if (!is_known || std::ranges::count(columns_, column) != 1) {
                refuse("found the column \"" + column + "\"" + (is_known ? " twice" : "") +
                       ", expected name, at, and if wanted access, raw_low, raw_high, low, high, "
                       "unit and description");
            }
        }
        for (const std::string_view needed : {"name", "at"}) {
            if (std::ranges::find(columns_, needed) == columns_.end()) {
                refuse("found no column \"" + std::string{needed} + "\"");
            }
        }
    }

    /// The next variable; nothing at the end.
    [[nodiscard]] std::optional<Written> next()
    {
        do {
            if (!read()) {
                return std::nullopt;
            }
        } while (now_.size() == 1 && now_.front().empty());
        if (now_.size() != columns_.size()) {
            refuse("found " + std::to_string(now_.size()) + " fields, expected " +
                   std::to_string(columns_.size()) + " as in the first line");
        }
        Written written{field("name"), field("at"),         field("access"), {},
                        field("unit"), field("description")};
        for (std::size_t i = 0; i < scale_keys.size(); ++i) {
            written.scale[i] = number(scale_keys[i]);
        }
        return written;
    }
    [[noreturn]] void refuse(const std::string& text) const
    {
        throw ConfigError{file_ + ":" + std::to_string(fields_.line()), text};
    }

private:
    static constexpr std::array<std::string_view, 9> known{
        "name", "at", "access", "raw_low", "raw_high", "low", "high", "unit", "description"};

    [[nodiscard]] bool read()
    {
        using Line = controller::detail::TableFields::Line;
        const Line line = fields_.next(now_);
        if (line == Line::Broken || line == Line::TooLarge) {
            refuse(line == Line::Broken ? "found a quotation mark without its end"
                                        : "found too many or too long fields, expected at most 64 "
                                          "of 1,024 bytes");
        }
        return line == Line::Read;
    }
    [[nodiscard]] std::string field(std::string_view column) const
    {
        const auto found = std::ranges::find(columns_, column);
        return found == columns_.end() ? std::string{}
                                       : now_[static_cast<std::size_t>(found - columns_.begin())];
    }
    [[nodiscard]] std::optional<double> number(std::string_view column) const
    {
        const std::string text = field(column);
        if (text.empty()) {
            return std::nullopt;
        }
        double value = 0;
        const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
        if (error != std::errc{} || end != text.data() + text.size()) {
            refuse(std::string{column} + ": found \"" + text + "\", expected a number");
        }
        return value;
    }

    std::string file_;
    controller::detail::TableFields fields_;
    std::vector<std::string> columns_;
    std::vector<std::string> now_;
};

/// "plc.example:502", "[2001:db8::1]:502".
void read_address(const TomlTable& table, backend::DeviceConfig& device)
{
    const std::string text = table.text("address");
    const std::size_t colon = text.rfind(':');
    std::string_view host = std::string_view{text}.substr(0, std::min(colon, text.size()));
    if (host.starts_with('[') && host.ends_with(']')) {
        host = host.substr(1, host.size() - 2);
    }
    unsigned port = 0;
    const char* const begin = text.data() + std::min(colon + 1, text.size());
    const auto [end, error] = std::from_chars(begin, text.data() + text.size(), port);
    if (colon == std::string::npos || host.empty() || error != std::errc{} ||
        end != text.data() + text.size() || port == 0 || port > 65'535) {
        table.fail("address", "host:port of the PLC");
    }
    device.host = host;
    device.port = static_cast<std::uint16_t>(port);
}

/// Reads where the PLC is, and how long it is waited for.
void read_connection(const TomlTable& table, backend::DeviceConfig& device)
{
    read_address(table, device);
    device.connect_timeout = milliseconds{table.integer("connect_ms", 5'000, 10, 600'000)};
    device.longest_pause = milliseconds{table.integer("longest_pause_ms", 30'000, 500, 3'600'000)};
}

template <typename T>
T whole(const TomlTable& table, std::string_view key, T otherwise, std::int64_t least,
        std::int64_t most)
{
    return static_cast<T>(table.integer(key, static_cast<std::int64_t>(otherwise), least, most));
}

ModbusProtocolOptions read_modbus(const TomlTable& table)
{
    ModbusProtocolOptions options;
    options.unit = whole(table, "unit", options.unit, 0, 255);
    options.client.is_gateway = table.flag("gateway", false);
    options.client.max_under_way = whole(table, "under_way", std::size_t{1}, 1, 64);
    options.client.timeout = milliseconds{table.integer("timeout_ms", 1'000, 10, 600'000)};
    options.max_gap = whole(table, "max_gap", options.max_gap, 0, 125);
    options.max_read = whole(table, "max_read", options.max_read, 1, 125);
    options.max_write = whole(table, "max_write", options.max_write, 1, 123);
    options.asks_identity = table.flag("identify", options.asks_identity);
    return options;
}

backend::SlmpFamily read_family(const TomlTable& table)
{
    using backend::SlmpFamily;
    const std::string family = table.text("family", "iq-r");
    for (const auto& [name, value] :
         {std::pair{"l", SlmpFamily::Q}, {"l-module", SlmpFamily::QModule}}) {
        if (family == name) {
            return value;
        }
    }
    const auto known = backend::find_slmp_family(family);
    if (!known) {
        table.fail("family",
                   "\"auto\", \"iq-r\", \"q\", \"l\", \"q-module\", \"l-module\" or \"fx5\"");
    }
    return *known;
}

/// Reads the remote password from the first line of its file. What is in there is never shown.
std::string read_password(const TomlTable& table, backend::SlmpFamily family)
{
    using backend::SlmpFamily;
    constexpr std::string_view key = "remote_password_file";
    constexpr std::size_t longest = 32;
    if (!table.has(key)) {
        return {};
    }
    const std::string path = table.text(key);
    std::ifstream file{path, std::ios::binary};
    std::string text(longest + 2, '\0');
    file.read(text.data(), static_cast<std::streamsize>(text.size()));
    if (file.bad() || (file.fail() && !file.eof())) {
        table.fail(key, "a file that can be read");
    }
    text.resize(static_cast<std::size_t>(file.gcount()));
    text.resize(std::min(text.find_first_of("\r\n"), text.size()));
    // SH-080956ENG, 1630.
    const bool is_q = family == SlmpFamily::Q || family == SlmpFamily::QModule;
    const bool fits_q = text.size() == 4;
    const bool fits_others = text.size() >= 6 && text.size() <= longest;
    const bool fits = is_q                         ? fits_q
                      : family == SlmpFamily::Auto ? fits_q || fits_others
                                                   : fits_others;
    const bool is_ascii =
        std::ranges::all_of(text, [](char each) { return each >= ' ' && each <= '~'; });
    if (!fits || !is_ascii) {
        table.refuse(key, path + ": found " + std::to_string(text.size()) +
                              (text.size() > longest ? " or more" : "") +
                              " characters in its first line, expected " +
                              (is_q                         ? "4"
                               : family == SlmpFamily::Auto ? "4, or 6 to 32"
                                                            : "6 to 32") +
                              " of ASCII");
    }
    return text;
}

SlmpProtocolOptions read_slmp(const TomlTable& table)
{
    const backend::SlmpFamily family = read_family(table);
    SlmpProtocolOptions options = backend::slmp_options(family);
    options.password = read_password(table, family);
    const std::string frame = table.text("frame", "auto");
    if (frame == "3E" || frame == "4E") {
        options.client.frame =
            frame == "3E" ? backend::SlmpFrame::Frame3E : backend::SlmpFrame::Frame4E;
        options.finds_frame = false;
    } else if (frame != "auto") {
        table.fail("frame", "\"auto\", \"3E\" or \"4E\"");
    }
    const std::string transport = table.text("transport", "tcp");
    if (transport != "tcp" && transport != "udp") {
        table.fail("transport", "\"tcp\" or \"udp\"");
    }
    options.client.is_datagram = transport == "udp";
    options.client.station.network = whole(table, "network", std::uint8_t{0}, 0, 239);
    options.client.station.station = whole(table, "station", std::uint8_t{0xFF}, 0, 255);
    options.client.station.module = whole(table, "module", std::uint16_t{0x3FF}, 0, 0x3FF);
    options.client.max_under_way = whole(table, "under_way", std::size_t{1}, 1, 64);
    options.client.timeout = milliseconds{table.integer("timeout_ms", 5'000, 10, 600'000)};
    options.max_gap = whole(table, "max_gap", options.max_gap, 0, 960);
    options.max_words = whole(table, "max_read", options.max_words, 1, 960);
    return options;
}

void read_variables(const TomlTable& table, BackendConfig& config)
{
    std::set<std::string, std::less<>> names;
    const auto add = [&](Written written, const auto& refuse) {
        auto checked = check(std::move(written), config);
        if (!checked) {
            refuse(checked.error());
        }
        if (!names.insert(checked->name).second) {
            refuse(Mistake{"name", "found \"" + checked->name + "\" again, expected another"});
        }
        if (config.variables.size() == most_backend_variables) {
            refuse(Mistake{"name", "expected no more than 100,000 variables"});
        }
        config.variables.push_back(*std::move(checked));
    };
    for (const TomlTable& entry : table.tables("variable")) {
        add(read_variable(entry),
            [&](const Mistake& mistake) { entry.refuse(mistake.key, mistake.text); });
    }
    const std::string file = table.text("table", "");
    if (file.empty()) {
        return;
    }
    const auto text = table.sources().text(file, most_table_size);
    if (!text) {
        table.refuse("table", busbar::text(text.error()));
    }
    VariableTable rows{file, **text};
    while (auto row = rows.next()) {
        add(*std::move(row), [&](const Mistake& mistake) {
            rows.refuse(std::string{mistake.key} + ": " + mistake.text);
        });
    }
}

backend::WhenStopped read_when_stopped(const TomlTable& table)
{
    using backend::WhenStopped;
    const std::string text = table.text("when_stopped", "uncertain");
    if (text != "uncertain" && text != "good" && text != "bad") {
        table.fail("when_stopped", "\"uncertain\", \"good\" or \"bad\"");
    }
    return text == "uncertain" ? WhenStopped::Uncertain
           : text == "good"    ? WhenStopped::Good
                               : WhenStopped::Bad;
}

BackendConfig read_backend(const TomlTable& table)
{
    constexpr std::string_view all[] = {
        "name",    "protocol", "address",          "under_way", "timeout_ms", "connect_ms",
        "max_gap", "max_read", "longest_pause_ms", "when_away", "table",      "variable"};
    std::vector<std::string_view> keys{std::begin(all), std::end(all)};
    BackendConfig config;
    config.name = table.text("name");
    const std::string protocol = table.text("protocol");
    if (protocol != "modbus" && protocol != "slmp") {
        table.fail("protocol", "\"modbus\" or \"slmp\"");
    }
    const bool is_modbus = protocol == "modbus";
    if (is_modbus) {
        keys.insert(keys.end(), {"unit", "gateway", "max_write", "identify"});
    } else {
        keys.insert(keys.end(), {"family", "frame", "transport", "network", "station", "module",
                                 "remote_password_file", "when_stopped"});
    }
    table.allow(keys);
    read_connection(table, config.device);
    config.device.name = config.name;
    if (is_modbus) {
        config.protocol = read_modbus(table);
    } else {
        config.protocol = read_slmp(table);
        config.source.when_stopped = read_when_stopped(table);
        config.device.is_datagram = std::get<1>(config.protocol).client.is_datagram;
    }
    const std::string when_away = table.text("when_away", "bad");
    if (when_away != "bad" && when_away != "last value") {
        table.fail("when_away", "\"bad\" or \"last value\"");
    }
    config.source.when_away =
        when_away == "bad" ? backend::WhenAway::Bad : backend::WhenAway::LastValue;
    read_variables(table, config);
    return config;
}

} // namespace

std::vector<DevicePoint> BackendConfig::points() const
{
    std::vector<DevicePoint> all;
    all.reserve(variables.size());
    for (const BackendVariable& variable : variables) {
        all.push_back(variable.point);
    }
    return all;
}

std::unique_ptr<backend::DeviceProtocol> BackendConfig::make_protocol() const
{
    const auto all = points();
    return protocol.index() == 0 ? backend::make_modbus_protocol(std::get<0>(protocol), all)
                                 : backend::make_slmp_protocol(std::get<1>(protocol), all);
}

std::span<const std::string_view> slmp_labels_keys()
{
    static constexpr std::array<std::string_view, 12> keys{
        "address",          "under_way", "timeout_ms", "connect_ms",
        "longest_pause_ms", "family",    "frame",      "transport",
        "network",          "station",   "module",     "remote_password_file"};
    return keys;
}

backend::SlmpLabelsOptions read_slmp_labels(const TomlTable& table)
{
    backend::SlmpLabelsOptions options;
    read_connection(table, options.device);
    options.device.name = "labels";
    options.protocol = read_slmp(table);
    options.device.is_datagram = options.protocol.client.is_datagram;
    return options;
}

std::string keys_text(const TomlTable& table, std::span<const std::string_view> keys)
{
    std::string all;
    for (const std::string_view key : keys) {
        if (table.has(key)) {
            const toml::node& node = *table.node(key);
            all += std::string{key} + "=" + node.value<std::string>().value_or("") +
                   std::to_string(node.value<std::int64_t>().value_or(0)) + ";";
        }
    }
    return all;
}

std::vector<BackendConfig> read_backends(const TomlTable& root)
{
    std::vector<BackendConfig> all;
    for (const TomlTable& entry : root.tables("backend")) {
        BackendConfig config = read_backend(entry);
        const bool is_name = !config.name.empty() && config.name.size() <= longest_name &&
                             std::ranges::all_of(config.name, [](char each) {
                                 return std::isalnum(static_cast<unsigned char>(each)) != 0 ||
                                        each == '_' || each == '-';
                             });
        if (!is_name) {
            entry.fail("name", "1 to 128 letters, digits, - or _");
        }
        for (const BackendConfig& other : all) {
            if (other.name == config.name) {
                entry.refuse("name", "found \"" + config.name + "\" again, expected another");
            }
        }
        if (all.size() == most_backends) {
            entry.fail("name", "no more than 64 backends");
        }
        all.push_back(std::move(config));
    }
    return all;
}

} // namespace busbar::product
