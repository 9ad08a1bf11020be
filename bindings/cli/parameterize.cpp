#include "parameterize.hpp"

#include "failure.hpp"

namespace cli {

Parameterization parameterize(const hmf_hierarchy* hierarchy, const Foliation& foliation, hmf_progress_fn progress,
                              void* progress_user, const std::string& name) {
    Parameterization result;
    result.corner_uv.resize(6 * foliation.triangle_count());
    hmf_parameterize_options options;
    hmf_parameterize_options_init(&options);
    options.progress = progress;
    options.progress_user = progress_user;
    hmf_parameterization& numbers = result.numbers;
    numbers.struct_size = sizeof numbers;
    numbers.triangle_capacity = foliation.triangle_count();
    numbers.corner_uv = result.corner_uv.data();
    hmf_error error{};
    const hmf_status status =
        hmf_parameterize(hierarchy, 0, foliation.values.data(), foliation.values.size(), &options, &numbers, &error);
    if (status == HMF_CANCELLED)
        throw Failure(EXIT_LIMIT, name + ": interrupted while parameterising; the other results were written");
    if (status != HMF_OK) fail_with(status, error, name);
    numbers.corner_uv = nullptr;
    return result;
}

} // namespace cli
