#include <busbar/model/units.hpp>

#include <algorithm>
#include <array>

namespace busbar::model {

namespace {

/// Part 8, 5.6.3.4.
constexpr std::string_view unece_uri = "http://www.opcfoundation.org/UA/units/un/cefact";

constexpr auto units = std::to_array<Unit>({
    // Length, area, volume.
    {"MTR", "m", "metre"},
    {"CMT", "cm", "centimetre"},
    {"MMT", "mm", "millimetre"},
    {"4H", "µm", "micrometre (micron)"},
    {"C45", "nm", "nanometre"},
    {"KMT", "km", "kilometre"},
    {"INH", "in", "inch"},
    {"FOT", "ft", "foot"},
    {"MTK", "m²", "square metre"},
    {"CMK", "cm²", "square centimetre"},
    {"MMK", "mm²", "square millimetre"},
    {"MTQ", "m³", "cubic metre"},
    {"CMQ", "cm³", "cubic centimetre"},
    {"LTR", "l", "litre"},
    {"MLT", "ml", "millilitre"},
    // Angle, speed, acceleration.
    {"C81", "rad", "radian"},
    {"DD", "°", "degree [unit of angle]"},
    {"MTS", "m/s", "metre per second"},
    {"C16", "mm/s", "millimetre per second"},
    {"KMH", "km/h", "kilometre per hour"},
    {"MSK", "m/s²", "metre per second squared"},
    {"2A", "rad/s", "radian per second"},
    {"E96", "°/s", "degree per second"},
    {"RPM", "r/min", "revolutions per minute"},
    // Time, frequency.
    {"SEC", "s", "second [unit of time]"},
    {"C26", "ms", "millisecond"},
    {"B98", "µs", "microsecond"},
    {"MIN", "min", "minute [unit of time]"},
    {"HUR", "h", "hour"},
    {"DAY", "d", "day"},
    {"HTZ", "Hz", "hertz"},
    {"KHZ", "kHz", "kilohertz"},
    {"MHZ", "MHz", "megahertz"},
    // Mass, force, torque, pressure.
    {"KGM", "kg", "kilogram"},
    {"GRM", "g", "gram"},
    {"MGM", "mg", "milligram"},
    {"TNE", "t", "tonne (metric ton)"},
    {"LBR", "lb", "pound"},
    {"NEW", "N", "newton"},
    {"B47", "kN", "kilonewton"},
    {"NU", "N·m", "newton metre"},
    {"PAL", "Pa", "pascal"},
    {"A97", "hPa", "hectopascal"},
    {"KPA", "kPa", "kilopascal"},
    {"MPA", "MPa", "megapascal"},
    {"BAR", "bar", "bar [unit of pressure]"},
    {"MBR", "mbar", "millibar"},
    {"PS", "lbf/in²", "pound-force per square inch"},
    // Temperature, density, viscosity, flow.
    {"CEL", "°C", "degree Celsius"},
    {"KEL", "K", "kelvin"},
    {"FAH", "°F", "degree Fahrenheit"},
    {"KMQ", "kg/m³", "kilogram per cubic metre"},
    {"C65", "Pa·s", "pascal second"},
    {"MQH", "m³/h", "cubic metre per hour"},
    {"MQS", "m³/s", "cubic metre per second"},
    {"L2", "l/min", "litre per minute"},
    {"KGS", "kg/s", "kilogram per second"},
    // Electricity, energy, power.
    {"AMP", "A", "ampere"},
    {"4K", "mA", "milliampere"},
    {"VLT", "V", "volt"},
    {"2Z", "mV", "millivolt"},
    {"KVT", "kV", "kilovolt"},
    {"OHM", "Ω", "ohm"},
    {"JOU", "J", "joule"},
    {"KJO", "kJ", "kilojoule"},
    {"KWH", "kW·h", "kilowatt hour"},
    {"MWH", "MW·h", "megawatt hour (1000 kW.h)"},
    {"WTT", "W", "watt"},
    {"KWT", "kW", "kilowatt"},
    {"MAW", "MW", "megawatt"},
    {"D46", "V·A", "volt - ampere"},
    // Light, sound, ratios, counts.
    {"LUX", "lx", "lux"},
    {"2N", "dB", "decibel"},
    {"P1", "%", "percent"},
    {"59", "ppm", "part per million"},
    {"C62", "1", "one"},
});

} // namespace

std::span<const Unit> common_units()
{
    return units;
}

EUInformation engineering_units(std::string_view common_code)
{
    const auto found = std::find_if(units.begin(), units.end(), [&](const Unit& unit) {
        return unit.common_code == common_code;
    });
    return engineering_units(found != units.end() ? *found : Unit{common_code, common_code, {}});
}

EUInformation engineering_units(const Unit& unit)
{
    EUInformation information;
    information.namespace_uri = String{unece_uri};
    information.unit_id = unit_id(unit.common_code);
    information.display_name = LocalizedText{String{unit.symbol}};
    if (!unit.name.empty()) {
        information.description = LocalizedText{String{unit.name}};
    }
    return information;
}

} // namespace busbar::model
