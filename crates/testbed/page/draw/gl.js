// Programs, buffers and textures of WebGL2.

/** Describes an attribute of floats in the bound buffer, for the bound array. */
export function attribute(gl, location, size, stride, offset, divisor) {
    gl.enableVertexAttribArray(location);
    gl.vertexAttribPointer(location, size, gl.FLOAT, false, stride, offset);
    gl.vertexAttribDivisor(location, divisor);
}

/** A square texture of depths, to be compared with, and the framebuffer that draws into it. */
export function depthMap(gl, size) {
    const texture = gl.createTexture();
    gl.bindTexture(gl.TEXTURE_2D, texture);
    gl.texStorage2D(gl.TEXTURE_2D, 1, gl.DEPTH_COMPONENT32F, size, size);
    for (const [name, value] of [
        [gl.TEXTURE_COMPARE_MODE, gl.COMPARE_REF_TO_TEXTURE],
        [gl.TEXTURE_MIN_FILTER, gl.LINEAR],
        [gl.TEXTURE_MAG_FILTER, gl.LINEAR],
        [gl.TEXTURE_WRAP_S, gl.CLAMP_TO_EDGE],
        [gl.TEXTURE_WRAP_T, gl.CLAMP_TO_EDGE],
    ]) {
        gl.texParameteri(gl.TEXTURE_2D, name, value);
    }
    const frame = gl.createFramebuffer();
    gl.bindFramebuffer(gl.FRAMEBUFFER, frame);
    gl.framebufferTexture2D(gl.FRAMEBUFFER, gl.DEPTH_ATTACHMENT, gl.TEXTURE_2D, texture, 0);
    return { texture, frame };
}

/** A program whose `use` sets uniforms by name; names that it doesn't have are left out. */
export function program(gl, vertex, fragment) {
    const made = gl.createProgram();
    for (const [type, source] of [[gl.VERTEX_SHADER, vertex], [gl.FRAGMENT_SHADER, fragment]]) {
        const shader = gl.createShader(type);
        gl.shaderSource(shader, source);
        gl.compileShader(shader);
        if (!gl.getShaderParameter(shader, gl.COMPILE_STATUS)) throw new Error(gl.getShaderInfoLog(shader));
        gl.attachShader(made, shader);
    }
    gl.linkProgram(made);
    if (!gl.getProgramParameter(made, gl.LINK_STATUS)) throw new Error(gl.getProgramInfoLog(made));
    const setters = new Map();
    for (let i = 0; i < gl.getProgramParameter(made, gl.ACTIVE_UNIFORMS); i++) {
        const { name, type } = gl.getActiveUniform(made, i);
        const at = gl.getUniformLocation(made, name);
        const set = {
            [gl.FLOAT]: (v) => gl.uniform1f(at, v),
            [gl.FLOAT_VEC2]: (v) => gl.uniform2fv(at, v),
            [gl.FLOAT_VEC3]: (v) => gl.uniform3fv(at, v),
            [gl.FLOAT_MAT4]: (v) => gl.uniformMatrix4fv(at, false, v),
        };
        setters.set(name.replace('[0]', ''), set[type] ?? (() => {}));
    }
    return {
        use(values) {
            gl.useProgram(made);
            for (const [name, value] of Object.entries(values)) setters.get(name)?.(value);
        },
    };
}
