/** For bundlers that turn `import address from 'foliations/hmf.wasm'` into an address. */
declare const address: string;
export default address;
