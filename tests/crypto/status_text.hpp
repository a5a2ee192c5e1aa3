#pragma once

#include <string>

#include <catch2/catch.hpp>

#include <busbar/core/text.hpp>

template <>
struct Catch::StringMaker<busbar::StatusCode> {
    static std::string convert(busbar::StatusCode code)
    {
        return code.is_good() ? "Good" : std::string{busbar::name(code)};
    }
};
