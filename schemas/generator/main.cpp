#include <cstdio>

#include "emit.hpp"
#if BUSBAR_GENERATE_NODES
#include "emit_nodes.hpp"
#include "emit_nodes_definitions.hpp"
#endif

namespace busbar::generator {

namespace {

Expected<nodeset::Document, Failure> load(const Options& options)
{
    nodeset::Document document;
    std::vector<std::string> paths;
    for (const Options::Dependency& dependency : options.dependencies) {
        paths.push_back(dependency.path);
    }
    paths.insert(paths.end(), options.inputs.begin(), options.inputs.end());
    Failure failure;
    for (const std::string& path : paths) {
        for (const Problem& problem : document.load_file(path)) {
            failure += (failure.empty() ? "" : "\n") + text(problem);
        }
    }
    if (!failure.empty()) {
        return Unexpected{failure};
    }
    return document;
}

/// The namespace of the first model of the first input.
std::string default_namespace(const nodeset::Document& document, const Options& options)
{
    nodeset::Document alone;
    static_cast<void>(alone.load_file(options.inputs.front()));
    return alone.models().empty() ? document.namespaces().back() : alone.models().front().uri;
}

Expected<void, Failure> emit_types(const nodeset::Document& document, const Options& options)
{
    const auto schema = make_schema(document, options);
    if (!schema) {
        return Unexpected{schema.error()};
    }
    const auto ids = emit_ids(*schema, document, options);
    if (!ids) {
        return Unexpected{ids.error()};
    }
    std::vector<std::pair<std::string, std::string>> files = {
        {"enumerations.hpp", emit_enumerations(*schema, options)},
        {"types.hpp", emit_umbrella(*schema, options)},
        {"fields.hpp", emit_fields(*schema, options)},
        {"ids.hpp", *ids},
        {"registry.hpp", emit_registry_header(*schema, options)},
        {"registry.cpp", emit_registry_source(*schema, options)}};
    for (const Schema::Group& group : schema->groups) {
        files.emplace_back(group.name + ".hpp", emit_header(*schema, group, options));
        files.emplace_back(group.name + ".cpp", emit_source(*schema, group, options));
    }
    for (const auto& [name, text] : files) {
        if (auto written = write_output(options, name, text); !written) {
            return written;
        }
    }
    return {};
}

Expected<void, Failure> run(Options options)
{
    const auto document = load(options);
    if (!document) {
        return Unexpected{document.error()};
    }
    if (options.namespace_uri.empty()) {
        options.namespace_uri = default_namespace(*document, options);
    }
#if BUSBAR_GENERATE_NODES
    if (options.nodes) {
        return emit_nodes(*document, options);
    }
    if (options.definitions) {
        return emit_definitions(*document, options);
    }
#endif
    return emit_types(*document, options);
}

} // namespace

} // namespace busbar::generator

int main(int argc, char** argv)
{
    using namespace busbar::generator;
    if (const auto text = argc == 2 ? answer(argv[1]) : std::nullopt) {
        std::fputs(text->c_str(), stdout);
        return 0;
    }
    const auto options = parse_options(argc, argv);
    const auto done = options ? run(*options) : busbar::Unexpected{options.error()};
    if (!done) {
        std::fprintf(stderr, "busbar-generate: %s\n", done.error().c_str());
        return 1;
    }
    return 0;
}
