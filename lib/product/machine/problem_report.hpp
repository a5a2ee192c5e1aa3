#pragma once

#include <string>

#include <busbar/core/problem.hpp>

#include "core/json_writer.hpp"

namespace busbar::product {

/// What a client reads of a file that was not taken: {"problem": "press.st:4:5: ..."}.
[[nodiscard]] inline std::string problem_report(const Problem& problem)
{
    detail::JsonWriter json;
    json.begin_object();
    json.name("problem");
    json.string(text(problem));
    json.end_object();
    return json.take();
}

} // namespace busbar::product
