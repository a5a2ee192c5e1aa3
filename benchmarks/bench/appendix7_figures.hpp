#pragma once

#include <array>
#include <cstddef>
#include <string_view>

namespace busbar::bench {

/// What the tables of SH-082679, Appendix 7, say; 0 where they have nothing.
struct ServiceFigures {
    std::string_view load;
    /// "standard", "items" or "all", as SevenOptions::modes.
    std::string_view mode;
    struct Column {
        std::size_t variables;
        double milliseconds;
    };
    std::array<Column, 8> columns{};
};

inline constexpr std::array<ServiceFigures, 9> service_figures{{
    {"read",
     "standard",
     {{{100, 50.4},
       {1'000, 472.9},
       {5'000, 2'461.0},
       {10'000, 6'647.8},
       {20'000, 20'165.3},
       {25'000, 30'026.3}}}},
    // The conditions name more Variables than the table of this mode has.
    {"subscription",
     "standard",
     {{{100, 200.0},
       {500, 200.0},
       {1'000, 226.3},
       {2'000, 439.9},
       {3'000, 676.2},
       {5'000, 0},
       {10'000, 0},
       {15'000, 0}}}},
    {"write",
     "standard",
     {{{100, 63.1}, {500, 217.5}, {1'000, 544.5}, {2'000, 1'155.7}, {3'000, 1'727.9}}}},
    {"read",
     "items",
     {{{100, 46.3},
       {1'000, 428.9},
       {5'000, 2'174.1},
       {10'000, 4'337.3},
       {20'000, 8'616.0},
       {25'000, 10'759.4}}}},
    {"subscription",
     "items",
     {{{100, 200.0}, {1'000, 213.1}, {5'000, 245.6}, {10'000, 501.2}, {15'000, 746.1}}}},
    {"write",
     "items",
     {{{100, 58.8}, {500, 199.3}, {1'000, 364.5}, {2'000, 1'095.3}, {3'000, 1'131.5}}}},
    {"read",
     "all",
     {{{100, 15.0},
       {1'000, 135.7},
       {5'000, 647.3},
       {10'000, 1'253.1},
       {20'000, 2'391.0},
       {25'000, 2'938.6}}}},
    {"subscription",
     "all",
     {{{100, 864.7}, {1'000, 877.8}, {5'000, 940.1}, {10'000, 1'020.8}, {15'000, 1'104.2}}}},
    {"write",
     "all",
     {{{100, 886.3}, {500, 1'099.4}, {1'000, 1'282.0}, {2'000, 1'746.2}, {3'000, 2'289.3}}}},
}};

struct StartupFigures {
    std::size_t files;
    std::size_t objects;   // of all files
    std::size_t variables; // of each Object
    bool is_mapped;
    /// Of "standard", "items" and "all".
    std::array<double, 3> seconds;
};

/// By the number of Variables, of Objects and of files; what two tables have stands once.
inline constexpr std::array<StartupFigures, 22> startup_figures{{
    {1, 1, 100, true, {18.3, 18.2, 18.2}},        {1, 1, 1'000, true, {21.4, 21.1, 21.8}},
    {1, 1, 5'000, true, {43.9, 43.5, 47.0}},      {1, 1, 10'000, true, {122.5, 98.6, 104.9}},
    {1, 1, 20'000, true, {316.5, 316.3, 328.1}},  {1, 1, 25'000, true, {480.4, 477.5, 499.4}},
    {1, 1, 100, false, {18.2, 18.2, 18.2}},       {1, 1, 1'000, false, {20.1, 19.7, 19.8}},
    {1, 1, 5'000, false, {38.9, 30.4, 30.5}},     {1, 1, 10'000, false, {87.2, 54.1, 54.2}},
    {1, 1, 20'000, false, {296.5, 145.1, 145.3}}, {1, 1, 25'000, false, {453.8, 212.1, 213.2}},
    {1, 10, 500, true, {32.7, 32.4, 35.5}},       {1, 100, 50, true, {32.0, 31.8, 35.2}},
    {1, 1'000, 5, true, {33.2, 32.8, 35.4}},      {1, 10, 500, false, {27.5, 25.9, 26.1}},
    {1, 100, 50, false, {27.2, 25.6, 26.0}},      {1, 1'000, 5, false, {28.3, 27.1, 26.9}},
    {5, 100, 50, true, {32.9, 32.7, 36.1}},       {10, 100, 50, true, {33.4, 33.2, 36.5}},
    {5, 100, 50, false, {27.9, 28.5, 28.6}},      {10, 100, 50, false, {28.3, 28.8, 29.1}},
}};

} // namespace busbar::bench
