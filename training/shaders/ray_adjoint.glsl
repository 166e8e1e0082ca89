// The adjoint of trace along a ray: walks the ray again and computes the derivatives of the loss by every sample. It
// has main() of the trace adjoint and of the direct adjoint; the file that includes this one defines scatter(), which
// stores the derivatives. It adds the point loss (Sun et al. 2022, "Direct Voxel Grid Optimization"), which compares
// not only the blend but the colour c_i of each sample with the pixel's own colour c*:  λ Σ_i w_i α* |√c_i − √c*|²
// (roots are close to encoded values). The blending weights w_i count as constants there, so that the point loss
// changes colours and never densities.
#include "trace/composite.glsl"
#include "rays/ray.glsl"

const float kMaxSensitivityDepth = 8.0;  // the largest optical depth that the opacity sensitivity sees

// ∂(point loss)/∂c_i / w_i. `root`: √c* of the pixel; `strength`: λ α*.
vec3 point_adjoint(vec3 c, vec3 root, float strength) {
    return strength * (1.0 - root * inversesqrt(max(c, vec3(1e-6))));
}

// Defined by the file that includes this one: stores the derivatives of the sample at which the walk stopped, by its σ
// and by its colour before the sigmoid. `weight`: its blending weight; `opacity_sensitivity`: |α ∂L/∂α|.
void scatter(float weight, float d_sigma, float opacity_sensitivity, vec3 d_raw);

void main() {
    const Ray ray = tile_ray();
    const vec4 d_ray = FETCH(adjoint, int(ray.index)), traced = FETCH(radiance, int(ray.index));
    const Composite whole = Composite(traced.rgb, 1.0 - traced.a, 0.0);
    const vec4 truth = FETCH(target, int(ray.index));
    const vec3 root = truth.a > 0.0 ? sqrt(max(truth.rgb, vec3(0.0)) / truth.a) : vec3(0.0);
    const float point_strength = push.weights.point * push.pixel_share * max(truth.a, 0.0);
    sample_begin(ray.direction, ray.view);
    Composite sum = composite_begin();
    March march = march_begin((ray.origin - push.box_min.xyz) / push.box_size.xyz,
                              ray.direction / push.box_size.xyz, d_ray != vec4(0.0) ? ray.range : vec2(kFar, 0.0));
    MarchInterval part;
    while (sum.transmittance >= push.box_min.w && march_next(march, part)) {
            const float delta = part.t_out - part.t_in;
            const vec3 c = sample_colour();
            const float weight = composite_add(sum, sigma, delta, c, 0.0);
            const vec3 d_c = weight * (d_ray.rgb + point_adjoint(c, root, point_strength));
            const float d_sigma = composite_adjoint(sum, whole, delta, c, d_ray.rgb, d_ray.a);
            // α ∂L/∂α = ∂L/∂σ (e^σδ − 1)/δ. The cap keeps opaque samples, whose σ hardly matters, from seeming
            // sensitive.
            const float e_depth = exp(min(sigma * delta, kMaxSensitivityDepth));
            const float opacity_sensitivity = abs(d_sigma) * (e_depth - 1.0) / delta;
            scatter(weight, d_sigma, opacity_sensitivity, d_c * c * (1.0 - c));
        }
}
